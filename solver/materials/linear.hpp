// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// Isotropic linear elasticity (Hooke's law, small strains).
struct LinearElastic {
    double stiffness_kpa = 1.0;  ///< Young's modulus E > 0
    double poisson_ratio = 0.3;  ///< nu in (-1, 0.5)

    /// First Lame parameter divided by E.
    double unit_lambda() const {
        return poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio));
    }
    /// Shear modulus divided by E.
    double unit_mu() const { return 0.5 / (1.0 + poisson_ratio); }
};

}  // namespace palpate
