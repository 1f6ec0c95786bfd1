// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

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
    double correlated_mm = 0;   ///< of the correlated part
    Index surface = 0;          ///< rows of different surfaces have independent noise
    Vec3 place = Vec3::Zero();  ///< of the node, reference, mm
    double range_mm = 1;        ///< the correlation falls to 1/e at this distance
};

/// Covariance (mm^2) between the noise of two different rows: exponential in their distance.
inline double noise_covariance(const LinearRow& a, const LinearRow& b) {
    if (a.surface != b.surface || a.correlated_mm == 0) return 0;
    return a.correlated_mm * b.correlated_mm * std::exp(-(a.place - b.place).norm() / a.range_mm);
}

inline double noise_variance(const LinearRow& row) {
    return row.independent_mm * row.independent_mm + row.correlated_mm * row.correlated_mm;
}

}  // namespace palpate
