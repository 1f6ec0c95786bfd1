// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "host/estimate/data_problem.hpp"
#include "host/estimate/noise_model.hpp"
#include "host/estimate/parameter.hpp"

namespace palpate {

/// Of the weak log-normal priors of a discrepancy.
inline constexpr double prior_sd_ln_amplitude = 1.0, prior_sd_ln_length = 1.0;

/// The hard ends and the weak priors of the discrepancy of one block.
struct DiscrepancyRange {
    /// s: from a hundredth of the typical noise to three times the rms that the model leaves where
    /// it fits best.
    std::array<double, 2> amplitude{0, 0};
    /// From 6 % of the extent to all of it: shorter fields hardly matter to parameters, and would
    /// be found in place of longer ones.
    std::array<double, 2> length_mm{0, 0}, length_s{0, 0};  ///< equal ends: known, or of no meaning
    /// Median of the amplitude's prior: what the unweighted residuals have beyond their noise. Long
    /// waves decide about them, whereas short ones decide about the likelihood.
    double typical_amplitude = 0;
    double typical_mm = 0, typical_s = 0;  ///< medians of the lengths' priors
};

/// Of all blocks. What the model leaves of a block is that of the residuals, or
/// less: that of the values that would fit best without its field, by the linearisation there. A
/// field takes residuals with it, and these would allow a larger field: parameters would be left to
/// it.
///   prediction   with columns
std::vector<DiscrepancyRange> discrepancy_ranges(const std::vector<Parameter>& parameters,
                                                 const Prediction& prediction,
                                                 const NoiseModel& noise);

/// ln of the weak priors (log-normal, sd 1 of ln s and of ln length) at a discrepancy.
double log_prior(const DiscrepancyRange& range, const Discrepancy& discrepancy);

}  // namespace palpate
