// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "host/apps/recover/inverse/contour_kernel.hpp"
#include "host/apps/recover/objectives/target_frame.hpp"
#include "host/apps/recover/objectives/voxel_terraces.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// One surface distance, linearised: residual + normal . (u - u_linearised), with noise that is in
/// part independent from row to row and in part correlated along the surface.
struct LinearRow {
    bool on_driven = false;
    Index position = 0;  ///< of its node among the driven or the observed nodes
    Vec3 normal = Vec3::Zero();
    double residual_mm = 0;
    double independent_mm = 1;  ///< standard deviation of the independent part
    Terraces terraces;          ///< the part that is correlated along the terraces of voxels
    double contour_mm = 0;      ///< standard deviation of the part that whoever drew it adds
    double slice_share = 0;     ///< of its variance: as drawn slice by slice
    SlicePlaces slices;
    Index surface = 0;          ///< rows of different surfaces have independent noise
    Vec3 place = Vec3::Zero();  ///< of the node, reference, mm
    std::array<double, max_terraces> range_mm{};  ///< the correlation of each wave falls to 1/e
    double weight = 1;  ///< in sums that the size of the noise is found from; less for outliers
};

/// The target's alignment as an unknown of its own: delta ~ N(0, covariance).
struct FramePrior {
    using Covariance = Eigen::Matrix<double, 6, 6>;
    TargetFrame frame;
    Covariance covariance = Covariance::Zero();  ///< zero: it is exact
    FrameMotion motion = FrameMotion::Zero();    ///< delta at which rows are linearised

    Index size() const { return covariance.isZero(0) ? 0 : 6; }
};

/// Correlation of what contours of one surface are off by at two of its rows, relative to
/// `contour_mm`: (1 - share) k(d) + share slice_correlation.
inline double contour_correlation(const LinearRow& a, const LinearRow& b) {
    const double distance = (a.place - b.place).norm(), share = a.slice_share;
    const double smooth = contour_correlation(distance);
    if (share == 0) return smooth;
    return (1.0 - share) * smooth + share * slice_correlation(a.slices, b.slices, distance);
}

/// Covariance (mm^2) that terraces of voxels give two rows of one surface, exponential in their
/// distance.
inline double terrace_covariance(const LinearRow& a, const LinearRow& b, double distance) {
    double sum = 0, range = 0, decay = 0;
    for (int k = 0; k < max_terraces; ++k) {
        const double wave = a.terraces.waves.col(k).dot(b.terraces.waves.col(k));
        if (wave == 0) continue;
        if (a.range_mm[k] != range) {
            range = a.range_mm[k];
            decay = std::exp(-distance / range);
        }
        sum += wave * decay;
    }
    return sum;
}

/// Covariance (mm^2) between the noise of two different rows: that of contours, and of terraces.
inline double noise_covariance(const LinearRow& a, const LinearRow& b) {
    if (a.surface != b.surface) return 0;
    return a.contour_mm * b.contour_mm * contour_correlation(a, b) +
           terrace_covariance(a, b, (a.place - b.place).norm());
}

/// What contours add (mm^2).
inline double contour_variance(const LinearRow& row) {
    return row.contour_mm * row.contour_mm * contour_correlation(row, row);
}

/// Of the parts (mm^2) that a row shares with its neighbours.
inline double correlated_variance(const LinearRow& row) {
    return row.terraces.variance() + contour_variance(row);
}

inline double noise_variance(const LinearRow& row) {
    return row.independent_mm * row.independent_mm + correlated_variance(row);
}

}  // namespace palpate
