// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/finer_mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "solver/base/error.hpp"
#include "solver/elements/tet10.hpp"
#include "solver/equilibrium/rest_solver.hpp"
#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

/// Of the solve: half the size changes displacements by a hundredth, of which a hundredth is seen.
constexpr double relative_tolerance = 1e-6;

using Edge = std::pair<Index, Index>;

/// As `FinerMesh::wall_middles_`.
std::map<Edge, std::vector<VertexWeight>> wall_middles(const BodyMesh& mesh,
                                                       const Settings& settings) {
    std::map<Edge, std::vector<VertexWeight>> found;
    std::map<Edge, int> num_walls;
    const RecoveryModel recovery = build_model(mesh, settings);
    const auto is_held = [&](const VertexWeight& part) {
        return std::binary_search(recovery.fixed.begin(), recovery.fixed.end(), part.vertex);
    };
    for (const ObservedSurface& wall : recovery.surfaces) {
        if (!wall.driven) continue;
        const EdgeMiddles middles(wall.surface, vertex_normals(wall.surface));
        std::map<Edge, std::vector<VertexWeight>> of_wall;
        for (const Triangle& triangle : wall.surface.triangles)
            for (int c = 0; c < 3; ++c) {
                const Index p = triangle[c], q = triangle[(c + 1) % 3];
                std::vector<VertexWeight> weights = middles.at(p, q);
                for (VertexWeight& part : weights) part.vertex = wall.node_of[part.vertex];
                // What is held beside what moves is no smooth motion.
                if (std::none_of(weights.begin(), weights.end(), is_held))
                    of_wall[std::minmax(wall.node_of[p], wall.node_of[q])] = std::move(weights);
            }
        for (auto& [edge, weights] : of_wall) {
            auto& all = found[edge];
            all.insert(all.end(), weights.begin(), weights.end());
            ++num_walls[edge];
        }
    }
    // Where walls touch, the mean of all.
    for (auto& [edge, weights] : found)
        for (VertexWeight& part : weights) part.weight /= num_walls[edge];
    return found;
}

}  // namespace

FinerMesh::FinerMesh(BodyMesh mesh, Settings settings, LinearSolverOptions options)
    : mesh_(std::move(mesh)),
      wall_middles_(wall_middles(mesh_, settings)),
      settings_(std::move(settings)),
      options_(std::move(options)) {
    options_.method = LinearMethod::multigrid;
    options_.expected_columns = 1;
    options_.relative_tolerance = relative_tolerance;
}

FinerMesh::Finer FinerMesh::finer_at(const std::vector<double>& kpa) const {
    Finer finer;
    const Index num_coarse = mesh_.mesh.num_nodes();
    const BodyMesh quadratic = with_mid_side_nodes(mesh_);
    finer.edges.resize(quadratic.mesh.num_nodes() - num_coarse);
    for (Index e = 0; e < quadratic.mesh.num_elements(); ++e) {
        const auto nodes = quadratic.mesh.nodes_of(e);
        for (std::size_t k = 0; k < tet10_edges.size(); ++k)
            finer.edges[nodes[4 + k] - num_coarse] = {nodes[tet10_edges[k][0]],
                                                      nodes[tet10_edges[k][1]]};
    }
    RecoveryModel recovery =
        build_model({solid_mesh_of(linear_mesh_of(quadratic.mesh)), quadratic.surface}, settings_);
    for (Index region = 0; region < static_cast<Index>(kpa.size()); ++region)
        set_stiffness(recovery.model, region, kpa[region]);
    finer.prescribed = recovery.model.prescribed;
    finer.solver = make_rest_solver(recovery.model, options_);
    return finer;
}

Eigen::VectorXd FinerMesh::change(const std::vector<double>& kpa,
                                  const Eigen::VectorXd& displacement,
                                  const ProgressSink& progress) const {
    check_cancelled(progress);
    const Finer body = finer_at(kpa);
    check_cancelled(progress);
    const Index num_coarse = mesh_.mesh.num_nodes();
    Columns interpolated(body.prescribed.size(), 1);
    interpolated.topRows(displacement.size()) = displacement;
    for (std::size_t k = 0; k < body.edges.size(); ++k) {
        const auto& [p, q] = body.edges[k];
        auto middle = interpolated.middleRows<3>(3 * (num_coarse + static_cast<Index>(k)));
        // On a straight edge of linear elements u(middle) = (u_p + u_q) / 2.
        middle = 0.5 * (displacement.segment<3>(3 * p) + displacement.segment<3>(3 * q));
        const auto wall = wall_middles_.find(std::minmax(p, q));
        if (wall == wall_middles_.end()) continue;
        middle.setZero();
        for (const auto& [node, weight] : wall->second)
            middle += weight * displacement.segment<3>(3 * node);
    }
    Columns prescribed = Columns::Zero(interpolated.rows(), 1);
    for (Index dof = 0; dof < interpolated.rows(); ++dof)
        if (body.prescribed[dof]) prescribed(dof, 0) = interpolated(dof, 0);
    Columns finer = interpolated;
    const LinearSolverSummary summary =
        body.solver->solve(prescribed, finer, [&](const Progress&) { check_cancelled(progress); });
    if (!summary.converged)
        throw Error(ErrorCode::solve_failed,
                    fmt::format("the solve on the finer mesh stopped at a relative residual of "
                                "{:.1e} ({}); try --precision double",
                                summary.relative_residual, summary.message));
    return finer.topRows(displacement.size()) - displacement;
}

}  // namespace palpate
