// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/types.hpp"

namespace palpate {

/// One surface distance, linearised: residual + normal . (u - u_linearised), with noise sigma.
struct LinearRow {
    bool on_driven = false;
    Index position = 0;  ///< of its node among the driven or the observed nodes
    Vec3 normal = Vec3::Zero();
    double residual_mm = 0;
    double sigma_mm = 1;
};

}  // namespace palpate
