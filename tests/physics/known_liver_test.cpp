// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "solver/linear/make_linear_solver.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/linear_solvers.hpp"
#include "tests/fixtures/meshes.hpp"

// A liver mesh with forces and displacements from another group's solver (data folder
// liver_known_force_inria): E = 20 kPa, nu = 0.45, resultant tool force shared equally by three
// nodes.
namespace palpate {
namespace {

constexpr double file_tolerance = 1e-4;  ///< displacements are stored with few digits
const std::vector<int> frames = {9, 19, 29, 39, 49};

struct Liver {
    Mesh mesh;
    std::vector<int> fixed;
    std::map<std::string, Eigen::VectorXd> displacement;  ///< mm
    std::map<int, Vec3> force;                            ///< frame -> resultant, mN
    std::vector<Index> tool_nodes;
};

/// Reads the parts of a legacy ASCII file that this data set has; metres become mm.
void read_vtk(const std::filesystem::path& path, Liver& liver) {
    std::ifstream file(path);
    std::string word, name;
    std::size_t count = 0;
    const auto read_vectors = [&](auto& values) {
        for (double& value : values) {
            file >> value;
            value *= 1000;
        }
    };
    while (file >> word) {
        if (word == "POINTS") {
            file >> count >> word;
            Eigen::VectorXd values(3 * count);
            read_vectors(values);
            for (std::size_t n = 0; n < count; ++n)
                liver.mesh.nodes.push_back(values.segment<3>(3 * n));
        } else if (word == "CELLS") {
            file >> count >> word;
            liver.mesh.tets.resize(count);
            for (Tet& tet : liver.mesh.tets) file >> word >> tet[0] >> tet[1] >> tet[2] >> tet[3];
        } else if (word == "SCALARS") {
            std::getline(file, word);
            std::getline(file, word);
            liver.fixed.resize(liver.mesh.nodes.size());
            for (int& flag : liver.fixed) file >> flag;
        } else if (word == "VECTORS") {
            file >> name >> word;
            Eigen::VectorXd values(3 * liver.mesh.nodes.size());
            read_vectors(values);
            liver.displacement[name] = values;
        }
    }
    liver.mesh.region.assign(liver.mesh.tets.size(), 0);
}

void read_forces(const std::filesystem::path& folder, Liver& liver) {
    std::string line, cell;
    std::ifstream forces(folder / "true_forces.csv");
    while (std::getline(forces, line)) {
        std::istringstream row(line);
        std::vector<std::string> cells;
        while (std::getline(row, cell, ',')) cells.push_back(cell);
        if (cells.size() < 5 || cells[0] != "linear") continue;
        liver.force[std::stoi(cells[1])] =
            1000 * Vec3(std::stod(cells[2]), std::stod(cells[3]), std::stod(cells[4]));
    }
    std::ifstream nodes(folder / "tool_nodes_linear.csv");
    std::getline(nodes, line);
    for (Index n; nodes >> n;) liver.tool_nodes.push_back(n);
}

class KnownLiver : public testing::TestWithParam<std::string> {};

TEST_P(KnownLiver, MovesAsTheOtherSolverSaysUnderTheListedForces) {
    const char* data = std::getenv("PALPATE_DATA");
    const std::filesystem::path folder =
        std::filesystem::path(data ? data : "") / "liver_known_force_inria";
    if (!std::filesystem::exists(folder / "liver_tets.vtk"))
        GTEST_SKIP() << "PALPATE_DATA does not hold liver_known_force_inria/liver_tets.vtk";
    if (const auto reason = fixtures::reason_to_skip(GetParam())) GTEST_SKIP() << *reason;
    Liver liver;
    read_vtk(folder / "liver_tets.vtk", liver);
    read_forces(folder, liver);
    ASSERT_EQ(liver.mesh.num_nodes(), 3046);
    ASSERT_EQ(liver.mesh.num_tets(), 10703);
    ASSERT_EQ(liver.tool_nodes.size(), 3u);
    Model model = fixtures::free_model(liver.mesh, {{20.0, 0.45}});
    Columns b = Columns::Zero(model.num_dofs(), frames.size()), u;
    for (Index n = 0; n < liver.mesh.num_nodes(); ++n)
        if (liver.fixed[n]) fixtures::prescribe(model, {n});
    for (std::size_t c = 0; c < frames.size(); ++c)
        for (Index n : liver.tool_nodes)
            b.block<3, 1>(3 * n, c) = liver.force.at(frames[c]) / liver.tool_nodes.size();
    LinearSolverOptions options = fixtures::solver_on(GetParam());

    const LinearSolverSummary summary = make_linear_solver(model, options)->solve(b, u);

    EXPECT_TRUE(summary.converged) << summary.message;
    for (std::size_t c = 0; c < frames.size(); ++c) {
        const std::string frame = std::to_string(100 + frames[c]).substr(1);
        const Eigen::VectorXd& expected = liver.displacement.at("u_linear_frame" + frame);
        EXPECT_LT((u.col(c) - expected).norm(), file_tolerance * expected.norm()) << frame;
    }
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, KnownLiver, testing::ValuesIn(fixtures::backend_names()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace palpate
