// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solver/model/solid_model.hpp"

namespace palpate {

/// What a time step makes of the relaxation function G(t) = g + sum a_k exp(-t / tau_k) of a
/// material. Of long-term moduli g = 1 and a_k = C_k; of instantaneous ones both are divided by
/// 1 + sum C_k. A step multiplies the stress S that relaxes by `factor` = g + sum part_k and takes
/// the histories to h_k' = kept_k h_k + part_k (S' - S) (method.md, 9.6).
/// The same numbers serve as changes of a step, and as slopes of a scalar by it.
struct RelaxationStep {
    struct Term {
        double kept = 0;  ///< exp(-x), x = dt / tau
        double part = 0;  ///< a (1 - exp(-x)) / x
    };
    double factor = 1;
    std::vector<Term> terms;
};

RelaxationStep relaxation_step(const SolidMaterial& material, double dt_s);

/// How a step changes with the terms and with its own length.
///   change     [terms] of amplitudes and times; empty: they stay
///   dt_change  of dt_s
RelaxationStep relaxation_step_change(const SolidMaterial& material, double dt_s,
                                      std::span<const RelaxationTerm> change, double dt_change);

/// From slopes by a step to slopes by the amplitudes and times of its terms, added to sum [terms].
void add_term_slopes(const SolidMaterial& material, double dt_s, const RelaxationStep& slopes,
                     std::vector<RelaxationTerm>& sum);

}  // namespace palpate
