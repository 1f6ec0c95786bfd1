// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/objectives/surface_observations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "host/surfaces/surface.hpp"

namespace palpate {
namespace {

std::map<Index, Index> positions(const std::vector<Index>& nodes) {
    std::map<Index, Index> position;
    for (std::size_t k = 0; k < nodes.size(); ++k) position[nodes[k]] = static_cast<Index>(k);
    return position;
}

/// The phase is that of the place in the reference: over the reach of the correlation all points
/// move about as far.
Terraces terraces_at(const Vec3& place, const Vec3& normal,
                     const std::vector<VoxelPlanes>& volumes) {
    Terraces terraces;
    for (std::size_t state = 0; state < volumes.size(); ++state) {
        const VoxelPlanes& voxels = volumes[state];
        const Vec3 deviation = voxels.terrace_deviation(normal);
        for (int a = 0; a < 3; ++a) {
            const double phase =
                2.0 * std::numbers::pi * voxels.axes.col(a).dot(place) / voxels.spacing[a];
            terraces.waves.col(3 * state + a) =
                deviation[a] * Eigen::Vector2d(std::cos(phase), std::sin(phase));
        }
    }
    return terraces;
}

}  // namespace

Vec3 VoxelPlanes::terrace_deviation(const Vec3& normal) const {
    constexpr int harmonics = 4;
    Vec3 deviation;
    for (int a = 0; a < 3; ++a) {
        const double h = spacing[a];
        const double cosine = std::min(1.0, std::abs(axes.col(a).dot(normal)) / normal.norm());
        const double waves = smoothing_mm / h;
        double variance = 0;
        for (int n = 1; n <= harmonics; ++n) {
            const double gauss = std::exp(-2.0 * std::numbers::pi * std::numbers::pi * waves *
                                          waves * n * n * (1.0 - cosine * cosine));
            const double rms = h / (std::numbers::sqrt2 * std::numbers::pi * n);
            variance += std::pow(rms * gauss * (2.0 - gauss), 2);
        }
        deviation[a] = std::sqrt(variance);
    }
    return deviation;
}

SurfaceObservations::SurfaceObservations(const RecoveryModel& recovery, ObservedShapes shapes,
                                         const std::vector<std::uint8_t>& node_is_seen,
                                         const ObservationOptions& options)
    : shapes_(std::move(shapes)) {
    for (std::size_t state = 0; state < options.voxels.size(); ++state) {
        for (int a = 0; a < 3; ++a) {
            terrace_range_mm_[3 * state + a] =
                options.terrace_range_spacings * options.voxels[state].spacing[a];
        }
    }
    const auto driven = positions(recovery.driven);
    const auto observed = positions(recovery.observed);
    std::vector<int> surfaces_at(recovery.model.mesh.nodes.size(), 0);
    for (const auto& surface : recovery.surfaces) {
        for (const Index node : surface.node_of) ++surfaces_at[node];
    }
    for (std::size_t s = 0; s < recovery.surfaces.size(); ++s) {
        const auto& surface = recovery.surfaces[s];
        if (!shapes_.target[s]) continue;
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
            row.place = surface.surface.vertices[v];
            const ShapeDistance own = shapes_.reference[s]->measure(row.place, Vec3::Zero());
            const Vec3& normal = own.normal;
            own_offset_.push_back(own.mm);
            facing_.push_back(normal);
            // Nodes that share a voxel share its information, and so do the two organs that meet at
            // one interface node.
            const double share =
                std::min(1.0, area[v] / std::max(options.independent_area_mm2,
                                                 shapes_.target[s]->measured_area_mm2()));
            row.independent_mm = options.noise_mm * std::sqrt(surfaces_at[node] / share);
            row.terraces = terraces_at(row.place, normal, options.voxels);
            row.terraces.waves *= std::sqrt(surfaces_at[node]);
            rows_.push_back(row);
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
        const ShapeDistance target =
            shapes_.target[row.surface]->measure(row.place + u, facing_[k]);
        state.residual_mm[k] = target.mm - own_offset_[k];
        state.normal.row(k) = target.normal;
        state.seen.push_back(target.is_seen);
    }
    return state;
}

}  // namespace palpate
