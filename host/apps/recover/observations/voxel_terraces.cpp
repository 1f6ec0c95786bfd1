// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/voxel_terraces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace palpate {
namespace {

/// The axis of `volume` with the same planes as those of spacing h across `direction`, or -1.
int matching_axis(const VoxelPlanes& volume, const Vec3& direction, double h) {
    for (int a = 0; a < 3; ++a) {
        const bool is_parallel = std::abs(volume.axes.col(a).dot(direction)) > 0.999;
        if (is_parallel && std::abs(volume.spacing[a] - h) < 0.01 * h) return a;
    }
    return -1;
}

/// Family of an axis whose planes no other volume has.
int own_family(std::size_t volume, int axis) { return static_cast<int>(3 * volume) + axis; }

/// E cos(2 pi x) for x ~ N(0, variance), in spacings.
double phase_known(double variance) {
    return std::exp(-2.0 * std::numbers::pi * std::numbers::pi * variance);
}

}  // namespace

Vec3 VoxelPlanes::terrace_deviation(const Vec3& normal) const {
    constexpr int harmonics = 4;
    Vec3 deviation;
    for (int a = 0; a < 3; ++a) {
        const double h = spacing[a];
        const double cosine = std::clamp(axes.col(a).dot(normal) / normal.norm(), -1.0, 1.0);
        const double waves = smoothing_mm / h;
        double variance = 0;
        for (int n = 1; n <= harmonics; ++n) {
            const double gauss = std::exp(-2.0 * std::numbers::pi * std::numbers::pi * waves *
                                          waves * n * n * (1.0 - cosine * cosine));
            const double rms = h / (std::numbers::sqrt2 * std::numbers::pi * n);
            variance += std::pow(rms * gauss * (2.0 - gauss), 2);
        }
        deviation[a] = std::copysign(std::sqrt(variance), cosine);
    }
    return deviation;
}

VoxelTerraces::VoxelTerraces(std::vector<VoxelPlanes> volumes, double range_spacings)
    : volumes_(std::move(volumes)) {
    for (std::size_t v = 0; v < volumes_.size(); ++v) {
        for (int a = 0; a < 3; ++a) {
            const double h = volumes_[v].spacing[a];
            const int own = own_family(v, a);
            const int shared = v == 0 ? -1 : matching_axis(volumes_[0], volumes_[v].axes.col(a), h);
            family_[v][a] = shared >= 0 ? shared : own;
            direction_[v][a] = shared >= 0 ? volumes_[0].axes.col(shared) : volumes_[v].axes.col(a);
            range_mm_[own] = range_spacings * h;
        }
    }
}

Terraces VoxelTerraces::of_distance(const Vec3& reference, const Vec3& reference_normal,
                                    const Vec3& target, const Vec3& target_normal) const {
    Terraces terraces;
    Vec3 first;  // deviations of the reference
    for (std::size_t v = 0; v < volumes_.size(); ++v) {
        const VoxelPlanes& voxels = volumes_[v];
        const Vec3& place = v == 0 ? reference : target;
        const Vec3 deviation = voxels.terrace_deviation(v == 0 ? reference_normal : target_normal);
        if (v == 0) first = deviation;
        for (int a = 0; a < 3; ++a) {
            const double h = voxels.spacing[a];
            const double phase =
                2.0 * std::numbers::pi * direction_[v][a].dot(place - voxels.origin) / h;
            const Eigen::Vector2d wave = (v == 0 ? -1.0 : 1.0) * deviation[a] *
                                         Eigen::Vector2d(std::cos(phase), std::sin(phase));
            const int own = own_family(v, a), family = family_[v][a];
            // rho = exp(-2 pi^2 (e^2 + e'^2) / h^2): what is known of the shift of the phase
            const double known =
                v == 0 || family == own
                    ? 1.0
                    : phase_known((std::pow(first[family], 2) + std::pow(deviation[a], 2)) /
                                  (h * h));
            terraces.waves.col(family) += known * wave;
            if (known < 1.0) terraces.waves.col(own) += std::sqrt(1.0 - known * known) * wave;
        }
    }
    return terraces;
}

}  // namespace palpate
