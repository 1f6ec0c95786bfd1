// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// The force of a tool that pulls at a liver, from a cloud of points of the part of the deformed
// surface that was seen (Mestdagh and Cotin 2022: another group's mesh, solver and cloud).
#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "host/apps/recover/pipeline/mechanics.hpp"
#include "host/apps/recover/pipeline/search_target.hpp"
#include "host/geometry/surfaces/point_shape.hpp"
#include "host/geometry/surfaces/surface_shape.hpp"

namespace palpate {
namespace {

constexpr double mm_per_m = 1000.0, mn_per_n = 1000.0;
constexpr Index liver = first_organ_region, tool = first_organ_region + 1;

std::filesystem::path data_folder() {
    const char* root = std::getenv("PALPATE_DATA");
    return std::filesystem::path(root ? root : "../shared/data") / "liver_known_force_inria";
}

/// Rows of numbers of a CSV file; text columns become 0.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string line, cell;
    std::getline(file, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(file, line)) {
        std::stringstream cells(line);
        rows.emplace_back();
        while (std::getline(cells, cell, ',')) rows.back().push_back(std::atof(cell.c_str()));
    }
    return rows;
}

struct Liver {
    Mesh mesh;  ///< mm
    std::vector<Index> fixed, tool_nodes;
    std::vector<Vec3> cloud;       ///< mm
    Vec3 force_mn = Vec3::Zero();  ///< true, last frame
};

Liver read_liver() {
    Liver result;
    vtkNew<vtkUnstructuredGridReader> reader;
    reader->SetFileName((data_folder() / "liver_tets.vtk").c_str());
    reader->ReadAllScalarsOn();
    reader->Update();
    vtkUnstructuredGrid* grid = reader->GetOutput();
    vtkDataArray* held = grid->GetPointData()->GetArray("fixed");
    for (vtkIdType n = 0; n < grid->GetNumberOfPoints(); ++n) {
        Vec3 x;
        grid->GetPoint(n, x.data());
        result.mesh.nodes.push_back(mm_per_m * x);
        if (held->GetTuple1(n) > 0) result.fixed.push_back(static_cast<Index>(n));
    }
    for (vtkIdType t = 0; t < grid->GetNumberOfCells(); ++t) {
        vtkNew<vtkIdList> corners;
        grid->GetCellPoints(t, corners);
        Tet tet;
        for (int c = 0; c < 4; ++c) tet[c] = static_cast<Index>(corners->GetId(c));
        result.mesh.tets.push_back(tet);
        result.mesh.region.push_back(liver);
    }
    for (const auto& row : read_rows(data_folder() / "tool_nodes_linear.csv")) {
        result.tool_nodes.push_back(static_cast<Index>(row[0]));
    }
    std::sort(result.tool_nodes.begin(), result.tool_nodes.end());
    for (const auto& row : read_rows(data_folder() / "pointcloud_linear_frame49.csv")) {
        result.cloud.emplace_back(mm_per_m * Vec3(row[0], row[1], row[2]));
    }
    const auto forces = read_rows(data_folder() / "true_forces.csv");
    result.force_mn = mn_per_n * Vec3(forces[4][2], forces[4][3], forces[4][4]);
    return result;
}

/// Faces of one tet only, counter-clockwise seen from outside.
std::vector<Triangle> boundary_faces(const Mesh& mesh) {
    std::map<Triangle, std::pair<int, Triangle>> faces;
    for (const Tet& tet : mesh.tets) {
        for (int skip = 0; skip < 4; ++skip) {
            Triangle face{tet[(skip + 1) % 4], tet[(skip + 2) % 4], tet[(skip + 3) % 4]};
            const Vec3& a = mesh.nodes[face[0]];
            const Vec3 normal = (mesh.nodes[face[1]] - a).cross(mesh.nodes[face[2]] - a);
            if (normal.dot(mesh.nodes[tet[skip]] - a) > 0) std::swap(face[1], face[2]);
            Triangle key = face;
            std::sort(key.begin(), key.end());
            auto& [uses, oriented] = faces[key];
            ++uses;
            oriented = face;
        }
    }
    std::vector<Triangle> boundary;
    for (const auto& [key, face] : faces) {
        if (face.first == 1) boundary.push_back(face.second);
    }
    return boundary;
}

ObservedSurface surface_of(const Mesh& mesh, const std::vector<Triangle>& faces, Index region,
                           bool driven) {
    ObservedSurface result{region, driven, {}, {}};
    std::map<Index, Index> vertex_of;
    for (const Triangle& face : faces) {
        Triangle corners;
        for (int c = 0; c < 3; ++c) {
            const auto [at, is_new] =
                vertex_of.try_emplace(face[c], static_cast<Index>(result.node_of.size()));
            if (is_new) {
                result.node_of.push_back(face[c]);
                result.surface.vertices.push_back(mesh.nodes[face[c]]);
            }
            corners[c] = at->second;
        }
        result.surface.triangles.push_back(corners);
    }
    return result;
}

RecoveryModel model_of(const Liver& input) {
    RecoveryModel recovery;
    const auto faces = boundary_faces(input.mesh);
    const auto in = [](const std::vector<Index>& list, Index node) {
        return std::binary_search(list.begin(), list.end(), node);
    };
    std::vector<Triangle> patch;
    for (const Triangle& face : faces) {
        if (std::all_of(face.begin(), face.end(),
                        [&](Index node) { return in(input.tool_nodes, node); })) {
            patch.push_back(face);
        }
    }
    recovery.surfaces = {surface_of(input.mesh, faces, liver, false),
                         surface_of(input.mesh, patch, tool, true)};
    recovery.fixed = input.fixed;
    recovery.driven = input.tool_nodes;
    for (const Index node : recovery.surfaces[0].node_of) {
        if (!in(recovery.fixed, node) && !in(recovery.driven, node)) {
            recovery.observed.push_back(node);
        }
    }
    std::sort(recovery.observed.begin(), recovery.observed.end());
    recovery.model.mesh = solid_mesh_of(input.mesh);
    recovery.model.materials.assign(4, {"linear", {20.0, 0.45}});
    recovery.model.prescribed.assign(3 * input.mesh.nodes.size(), 0);
    for (const auto* nodes : {&recovery.fixed, &recovery.driven}) {
        for (const Index node : *nodes) {
            for (int c = 0; c < 3; ++c) recovery.model.prescribed[3 * node + c] = 1;
        }
    }
    return recovery;
}

TEST(LiverForce, IsFoundFromThePartOfTheSurfaceThatWasSeen) {
    if (!std::filesystem::exists(data_folder())) {
        GTEST_SKIP() << "needs " << data_folder() << " (PALPATE_DATA)";
    }
    const Liver input = read_liver();
    PriorSettings prior;
    prior.displacement_sd_mm = 50;
    MechanicsOptions options;
    options.response.tolerance_mm = 1e-3;
    StageTimer timer;
    const Mechanics mechanics = make_mechanics(model_of(input), prior, {}, options, timer);
    ASSERT_EQ(mechanics.recovery.surfaces[1].surface.triangles.size(), 1u);
    ObservedShapes shapes;
    const auto rest = std::make_shared<SurfaceShape>(mechanics.recovery.surfaces[0].surface);
    const auto outward = [&](const Vec3& x) { return rest->measure(x, Vec3::Zero()).normal; };
    ObservationOptions seen;
    seen.noise_mm = 1.0;
    seen.independent_area_mm2 = 1.0;
    shapes.reference.assign(2, rest);
    shapes.target = {std::make_shared<PointShape>(input.cloud, outward), nullptr};
    const SurfaceObservations observations(
        mechanics.recovery, shapes, std::vector<std::uint8_t>(input.mesh.nodes.size(), 1), seen);

    RecoverOptions how;
    how.search.max_iterations = 100;
    // Estimated, the noise takes neighbours on a smooth cloud for independent: 0.6 mm, and an
    // interval that is half as wide and misses the truth.
    how.search.estimate_noise = false;
    Recovered found;
    found.recovery = mechanics.recovery;
    FullSolver full_solver(found.recovery.model, {}, 4);
    search_model(found, mechanics, full_solver, nullptr, observations, how, timer, {});

    Vec3 force = Vec3::Zero();
    for (const Index node : input.tool_nodes) force += found.force.segment<3>(3 * node);
    std::printf(
        "    true (%.3f, %.3f, %.3f) N, found (%.3f, %.3f, %.3f) +- (%.3f, %.3f, %.3f) N, "
        "noise %.3f mm, %d iterations: %s\n",
        input.force_mn[0] / 1e3, input.force_mn[1] / 1e3, input.force_mn[2] / 1e3, force[0] / 1e3,
        force[1] / 1e3, force[2] / 1e3, 1.96e-3 * found.resultant_sd[1][0],
        1.96e-3 * found.resultant_sd[1][1], 1.96e-3 * found.resultant_sd[1][2],
        seen.noise_mm * found.estimate.noise_level.scale, found.estimate.termination.iterations,
        found.estimate.termination.reason.c_str());
    EXPECT_LT((force - input.force_mn).norm(), 0.10 * input.force_mn.norm());
    for (int c = 0; c < 3; ++c) {
        EXPECT_LT(std::abs(force[c] - input.force_mn[c]), 1.96 * found.resultant_sd[1][c]);
    }
    EXPECT_LT(1.96 * found.resultant_sd[1].norm(), 0.15 * input.force_mn.norm());
}

}  // namespace
}  // namespace palpate
