// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/surface_observations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "host/apps/recover/observations/edge_middles.hpp"
#include "host/geometry/surfaces/surface.hpp"

namespace palpate {
namespace {

std::map<Index, Index> positions(const std::vector<Index>& nodes) {
    std::map<Index, Index> position;
    for (std::size_t k = 0; k < nodes.size(); ++k) position[nodes[k]] = static_cast<Index>(k);
    return position;
}

/// sum_p w_p d(x_p) of a row's patch at rest.
double own_mean(const TargetShape& reference, const Observation& row) {
    double mean = 0;
    for (std::size_t p = 0; p < row.patch.offsets.size(); ++p)
        mean += row.patch.weights[p] *
                reference.measure(row.place + row.patch.offsets[p], Vec3::Zero()).mm;
    return mean;
}

}  // namespace

SurfaceObservations::SurfaceObservations(const RecoveryModel& recovery, ObservedShapes shapes,
                                         const std::vector<std::uint8_t>& node_is_seen,
                                         const ObservationOptions& options)
    : terraces_(options.voxels, options.terrace_range_spacings), shapes_(std::move(shapes)) {
    const auto driven = positions(recovery.driven);
    const auto observed = positions(recovery.observed);
    // Quadratic elements have nodes in the middles of edges.
    const bool over_patches = options.over_patches && recovery.model.mesh.type == ElementType::tet4;
    const auto moving = [&](Index node) -> MovingNode {
        if (const auto found = driven.find(node); found != driven.end())
            return {true, found->second};
        const auto found = observed.find(node);
        return {false, found == observed.end() ? -1 : found->second};
    };
    std::vector<int> surfaces_at(recovery.model.mesh.nodes.size(), 0);
    for (const auto& surface : recovery.surfaces) {
        for (const Index node : surface.node_of) ++surfaces_at[node];
    }
    for (std::size_t s = 0; s < recovery.surfaces.size(); ++s) {
        const auto& surface = recovery.surfaces[s];
        if (!shapes_.target[s]) continue;
        const auto area = vertex_areas(surface.surface);
        const auto normals = vertex_normals(surface.surface);
        const auto patches = surface_patches(surface.surface, normals);
        const EdgeMiddles middles(surface.surface, normals);
        // What is held beside what moves is no smooth motion.
        const auto middle_of = [&](const std::vector<VertexWeight>& smooth,
                                   const std::array<MovingNode, 2>& ends) {
            std::vector<WeightedNode> nodes;
            for (const auto& [vertex, weight] : smooth)
                nodes.push_back({moving(surface.node_of[vertex]), weight});
            if (std::all_of(nodes.begin(), nodes.end(),
                            [](const WeightedNode& one) { return one.node.position >= 0; }))
                return nodes;
            return std::vector<WeightedNode>{{ends[0], 0.5}, {ends[1], 0.5}};
        };
        for (std::size_t v = 0; v < surface.node_of.size(); ++v) {
            const Index node = surface.node_of[v];
            const MovingNode own_node = moving(node);
            if (own_node.position < 0 || !node_is_seen[node] || area[v] <= 0) continue;
            Observation row;
            row.surface = static_cast<Index>(s);
            row.node = node;
            row.on_driven = own_node.on_driven;
            row.position = own_node.position;
            row.place = surface.surface.vertices[v];
            const ShapeDistance own = shapes_.reference[s]->measure(row.place, Vec3::Zero());
            row.facing = own.normal;
            const auto is_seen = [&](Index end) { return node_is_seen[surface.node_of[end]] != 0; };
            if (over_patches && shapes_.target[s]->is_of_voxels() &&
                std::all_of(patches[v].ends.begin(), patches[v].ends.end(), is_seen))
                row.patch = patches[v];
            for (const Index end : row.patch.ends)
                row.patch_nodes.push_back(middle_of(middles.at(static_cast<Index>(v), end),
                                                    {own_node, moving(surface.node_of[end])}));
            own_offset_.push_back(own_mean(*shapes_.reference[s], row));
            // The places of a node's patch are as many measurements, but those that share a voxel
            // share its information, and so do the two organs that meet at one interface node.
            const double share = std::min(
                row.patch.num_places(), area[v] / std::max(options.independent_area_mm2,
                                                           shapes_.target[s]->measured_area_mm2()));
            row.independent_mm = options.noise_mm * std::sqrt(surfaces_at[node] / share);
            row.num_measured = std::max(1.0, share);
            row.shared_factor = std::sqrt(surfaces_at[node]);
            rows_.push_back(row);
        }
    }
    frame_.points = options.aligned;
    frame_.independent_mm = options.noise_mm;
    for (const AlignedPoint& point : frame_.points) {
        frame_.frame.centre += point.place / double(frame_.points.size());
        frame_.terraces.push_back(
            terraces_.of_distance(point.place, point.normal, point.place, point.normal));
    }
}

ShapeDistance SurfaceObservations::distance_of(const Observation& row,
                                               const std::vector<Vec3>& moved) const {
    const TargetShape& target = *shapes_.target[row.surface];
    ShapeDistance mean = target.measure(row.place + moved[0], row.facing);
    if (moved.size() == 1) return mean;
    // sum_p w_p d(x_p + u_p), and sum_p w_p n_p
    mean.mm *= row.patch.weights[0];
    mean.normal *= row.patch.weights[0];
    mean.smooth_normal *= row.patch.weights[0];
    for (std::size_t p = 1; p < moved.size(); ++p) {
        const ShapeDistance there =
            target.measure(row.place + row.patch.offsets[p] + moved[p], row.facing);
        mean.mm += row.patch.weights[p] * there.mm;
        mean.normal += row.patch.weights[p] * there.normal;
        mean.smooth_normal += row.patch.weights[p] * there.smooth_normal;
    }
    return mean;
}

ObservedState SurfaceObservations::evaluate(const Eigen::VectorXd& driven,
                                            const Eigen::VectorXd& observed,
                                            const FrameMotion& frame) const {
    ObservedState state;
    state.residual_mm.resize(num_rows());
    state.normal.resize(num_rows(), 3);
    state.smooth_normal.resize(num_rows(), 3);
    state.place.resize(num_rows(), 3);
    std::vector<Vec3> moved;
    for (Index k = 0; k < num_rows(); ++k) {
        const auto& row = rows_[k];
        const Vec3 u = MovingNode{row.on_driven, row.position}.displacement(driven, observed);
        const Vec3 of_frame = frame_.frame.displacement(frame, row.place);
        moved.assign(1, u + of_frame);
        for (const auto& nodes : row.patch_nodes) {
            moved.push_back(of_frame);
            for (const auto& [node, weight] : nodes)
                moved.back() += weight * node.displacement(driven, observed);
        }
        state.place.row(k) = row.place + moved[0];
        const ShapeDistance target = distance_of(row, moved);
        state.residual_mm[k] = target.mm - own_offset_[k];
        state.normal.row(k) = target.normal;
        state.smooth_normal.row(k) = target.smooth_normal;
        state.seen.push_back(target.is_seen);
    }
    return state;
}

std::vector<Terraces> SurfaceObservations::terraces(const ObservedState& state) const {
    std::vector<Terraces> all;
    for (Index k = 0; k < num_rows(); ++k) {
        all.push_back(terraces_.of_distance(rows_[k].place, rows_[k].facing, state.place.row(k),
                                            state.normal.row(k)));
        all.back().waves *= rows_[k].shared_factor;
    }
    return all;
}

}  // namespace palpate
