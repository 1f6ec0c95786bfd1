// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Two layers of tissue, one on the other, are stretched. How far does the plane between them move,
// and how does that change with either modulus?
//
//     build/release/bin/example_solve [opencl|kokkos|reference]
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "solver/adjoint/adjoint.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/make_linear_solver.hpp"

namespace {

using namespace palpate;

constexpr int cells = 8;  // along each edge, half of them in either layer
constexpr double edge_mm = 40, stretch_mm = 0.4;
constexpr double lower_kpa = 10, upper_kpa = 20;

/// A cube of layers 0 (below) and 1; each cell is six tetrahedra along its diagonal (Kuhn 1960).
Mesh layered_cube() {
    Mesh mesh;
    for (int k = 0; k <= cells; ++k)
        for (int j = 0; j <= cells; ++j)
            for (int i = 0; i <= cells; ++i) mesh.nodes.push_back(Vec3(i, j, k) * edge_mm / cells);
    const auto node = [](const std::array<int, 3>& at) {
        return static_cast<Index>(at[0] + (cells + 1) * (at[1] + (cells + 1) * at[2]));
    };
    for (int cell = 0; cell < cells * cells * cells; ++cell) {
        std::array<int, 3> order{0, 1, 2};
        do {
            std::array<int, 3> at{cell % cells, cell / cells % cells, cell / cells / cells};
            const Index layer = at[2] < cells / 2 ? 0 : 1;
            Tet tet{node(at)};
            for (int step = 0; step < 3; ++step) {
                ++at[order[step]];
                tet[step + 1] = node(at);
            }
            mesh.tets.push_back(tet);
            mesh.region.push_back(layer);
            if (tet_volume(mesh, mesh.num_tets() - 1) < 0)
                std::swap(mesh.tets.back()[2], mesh.tets.back()[3]);
        } while (std::next_permutation(order.begin(), order.end()));
    }
    return mesh;
}

/// A model is a mesh, a material for each region, and which displacements are given: here those
/// along the axes at three sides, and the stretch at the top.
Model stretched_cube() {
    Model model{layered_cube(), {{lower_kpa, 0.0}, {upper_kpa, 0.0}}, {}};
    for (const Vec3& x : model.mesh.nodes)
        for (int axis = 0; axis < 3; ++axis)
            model.prescribed.push_back(x[axis] == 0 || (axis == 2 && x[axis] == edge_mm));
    return model;
}

/// Averages over the nodes of the plane between the layers: J(u) = mean u_z, and dJ/du.
Columns average_of_middle(const Model& model) {
    Columns weights = Columns::Zero(model.num_dofs(), 1);
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        if (model.mesh.nodes[n].z() == edge_mm / 2)
            weights(3 * n + 2, 0) = 1.0 / ((cells + 1) * (cells + 1));
    return weights;
}

bool tell(const char* what, double found, double expected, const char* unit) {
    fmt::print("{:32} {:9.6f} {} (closed form {:.6f})\n", what, found, unit, expected);
    return std::abs(found - expected) < 1e-5 * std::abs(expected);
}

int run(const std::string& backend) {
    const Model model = stretched_cube();
    LinearSolverOptions options;
    options.backend = backend;
    const auto solver = make_linear_solver(model, options);

    // K u = f: forces (mN) at free and displacements (mm) at prescribed degrees of freedom.
    Columns load = Columns::Zero(model.num_dofs(), 1), u;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        if (model.mesh.nodes[n].z() == edge_mm) load(3 * n + 2, 0) = stretch_mm;
    if (!solver->solve(load, u).converged) throw Error(ErrorCode::solve_failed, "no solution");
    const LinearSolverInfo how = solver->describe();
    fmt::print("{} nodes; {}: {}\n", model.mesh.num_nodes(), name_of(how.method), how.reason);

    // One more solve gives the derivatives by all moduli.
    const Columns average = average_of_middle(model);
    const LoadGradient gradient = load_gradient(model, *solver, u, average);

    // Without lateral contraction the layers are springs in series: J = d E_2 / (E_1 + E_2).
    const double sum = lower_kpa + upper_kpa;
    bool fits = tell("the middle moves by", average.cwiseProduct(u).sum(),
                     stretch_mm * upper_kpa / sum, "mm");
    fits &= tell("per kPa of the lower layer", gradient.stiffness_kpa[0],
                 -stretch_mm * upper_kpa / (sum * sum), "mm");
    fits &= tell("per kPa of the upper layer", gradient.stiffness_kpa[1],
                 stretch_mm * lower_kpa / (sum * sum), "mm");
    return fits ? 0 : 1;
}

}  // namespace

int main(int count, char** words) {
    try {
        return run(count > 1 ? words[1] : "reference");
    } catch (const palpate::Error& error) {
        fmt::print(stderr, "example_solve: {}\n", error.what());
        return 1;
    }
}
