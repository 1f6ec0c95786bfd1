// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/objectives/surface_observations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "host/surfaces/surface.hpp"

namespace palpate {
namespace {

std::map<Index, Index> positions(const std::vector<Index>& nodes) {
    std::map<Index, Index> position;
    for (std::size_t k = 0; k < nodes.size(); ++k) position[nodes[k]] = static_cast<Index>(k);
    return position;
}

}  // namespace

SurfaceObservations::SurfaceObservations(const RecoveryModel& recovery, ObservedMaps maps,
                                         const std::vector<std::uint8_t>& node_is_seen,
                                         const ObservationOptions& options)
    : maps_(std::move(maps)) {
    const auto driven = positions(recovery.driven);
    const auto observed = positions(recovery.observed);
    std::vector<int> surfaces_at(recovery.model.mesh.nodes.size(), 0);
    for (const auto& surface : recovery.surfaces) {
        for (const Index node : surface.node_of) ++surfaces_at[node];
    }
    for (std::size_t s = 0; s < recovery.surfaces.size(); ++s) {
        const auto& surface = recovery.surfaces[s];
        const auto area = vertex_areas(surface.surface);
        for (std::size_t v = 0; v < surface.node_of.size(); ++v) {
            const Index node = surface.node_of[v];
            const auto as_driven = driven.find(node);
            const auto as_observed = observed.find(node);
            const bool moves = as_driven != driven.end() || as_observed != observed.end();
            if (!moves || !node_is_seen[node] || area[v] <= 0) continue;
            Observation row;
            row.surface = static_cast<Index>(s);
            row.node = node;
            row.on_driven = as_driven != driven.end();
            row.position = row.on_driven ? as_driven->second : as_observed->second;
            // Nodes closer together than the noise is correlated share its information, and so do
            // the two organs that meet at one interface node.
            const double share =
                std::min(1.0, area[v] / options.correlation_area_mm2) / surfaces_at[node];
            row.sigma_mm = options.noise_mm / std::sqrt(share);
            rows_.push_back(row);
            position_.push_back(surface.surface.vertices[v]);
            own_offset_.push_back(maps_.reference[s].value(position_.back()));
        }
    }
}

ObservedState SurfaceObservations::evaluate(const Eigen::VectorXd& driven,
                                            const Eigen::VectorXd& observed) const {
    ObservedState state;
    state.residual_mm.resize(num_rows());
    state.normal.resize(num_rows(), 3);
    for (Index k = 0; k < num_rows(); ++k) {
        const auto& row = rows_[k];
        const Vec3 u = (row.on_driven ? driven : observed).segment<3>(3 * row.position);
        Vec3 gradient;
        const double distance = maps_.target[row.surface].value(position_[k] + u, gradient);
        state.residual_mm[k] = distance - own_offset_[k];
        state.normal.row(k) = gradient;
    }
    return state;
}

}  // namespace palpate
