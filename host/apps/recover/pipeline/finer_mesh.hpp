// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/observations/edge_middles.hpp"
#include "solver/linear/linear_solver.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// The body with every linear tetrahedron cut in eight, which tells how much of a displacement is
/// due to the size of the elements. It is there only while it is asked: it takes 250 MB of 6,000
/// nodes.
class FinerMesh {
public:
    /// `mesh`: of tet4. Solved by multigrid whatever `options` says: with eight times the elements
    /// a factorisation takes minutes and gigabytes.
    FinerMesh(BodyMesh mesh, Settings settings, LinearSolverOptions options);

    /// u_h/2 - u_h at the nodes of the coarser mesh, mm.
    ///   kpa           moduli of all regions
    ///   displacement  u_h [3 num_nodes] mm, in equilibrium at these moduli; its prescribed values
    ///                 are held, between the nodes as smooth walls move (EdgeMiddles)
    /// Throws Error(solve_failed) if the finer equilibrium is not found.
    Eigen::VectorXd change(const std::vector<double>& kpa, const Eigen::VectorXd& displacement,
                           const ProgressSink& progress) const;

private:
    using Edge = std::pair<Index, Index>;

    struct Finer {
        std::vector<Edge> edges;               ///< of the nodes that are new
        std::vector<std::uint8_t> prescribed;  ///< [3 num_nodes of the finer mesh]
        std::unique_ptr<LinearSolver> solver;
    };
    Finer finer_at(const std::vector<double>& kpa) const;

    BodyMesh mesh_;
    /// Of each edge of a driven surface: nodes and the weights of their displacements.
    std::map<Edge, std::vector<VertexWeight>> wall_middles_;
    Settings settings_;
    LinearSolverOptions options_;
};

}  // namespace palpate
