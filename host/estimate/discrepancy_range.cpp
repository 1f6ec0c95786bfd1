// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/discrepancy_range.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "host/estimate/quadratic_step.hpp"
#include "host/estimate/robust_spread.hpp"

namespace palpate {
namespace {

/// The prior's median of a length, in extents of the data.
constexpr double typical_extents = 1.0 / 6.0;
/// A length is not below this share of the extent: what varies faster is told from noise easily, so
/// that the likelihood, which weighs all wave lengths alike, would choose it and claim that the
/// long waves, on which parameters rest, are free of error.
constexpr double least_extents = 0.06;
/// An amplitude is not above so many rms of the residuals: a rough field can as well be a long one
/// of huge amplitude, which leaves nothing for the model.
constexpr double max_residual_rms = 3.0;
/// The parameters take some of a field for signal: it is larger than what they leave of it.
constexpr double taken_by_the_fit = 1.5;
/// Residuals count in that rms up to so many robust sd.
constexpr double max_robust_sd = 4.0;

double robust_rms(const Eigen::VectorXd& residual) {
    const double limit = max_robust_sd * sd_over_mad * middle_of(residual.cwiseAbs());
    const Eigen::VectorXd limited = residual.cwiseMax(-limit).cwiseMin(limit);
    return limited.norm() / std::sqrt(static_cast<double>(residual.size()));
}

/// Ends of one length and its prior's median, from what is known of it and the data's extent.
std::pair<std::array<double, 2>, double> length_range(double known, double spacing, double extent) {
    if (known > 0) return {{known, known}, known};
    if (!(extent > 0)) return {{1.0, 1.0}, 1.0};
    const double least = std::min(std::max(spacing, least_extents * extent), 0.5 * extent);
    return {{least, extent}, std::max(least, typical_extents * extent)};
}

/// What is left of a block's residuals where the values fit best without a field of its own,
///   r - J d,   d = (J^T C^-1 J + P)^-1 (J^T C^-1 r + P (m - t)),
/// d no longer than a step of a search may be. Rows that are outliers there count less, not those
/// that are so under the field.
Eigen::VectorXd left_without_field(const std::vector<Parameter>& parameters,
                                   const Prediction& prediction, NoiseModel noise, Index b) {
    constexpr int num_weighting = 2;
    const Eigen::VectorXd transformed = to_transformed(parameters, prediction.values);
    const Eigen::VectorXd slopes = slopes_of(parameters, transformed);
    noise.set_discrepancy(b, {});
    Prediction moved = prediction;
    for (int round = 0; round < num_weighting; ++round) {
        const Eigen::VectorXd step = quadratic_step(
            parameters, transformed, normal_equations(parameters, prediction, noise));
        for (std::size_t k = 0; k < moved.blocks.size(); ++k)
            moved.blocks[k].predicted = prediction.blocks[k].predicted +
                                        transformed_columns(prediction.blocks[k], slopes) * step;
        noise.reweight(moved);
    }
    return residual_of(moved.blocks[b]);
}

DiscrepancyRange range_of_block(const DataBlock& block, const RowGrid& grid,
                                const Eigen::VectorXd& left, Index num_parameter) {
    DiscrepancyRange range;
    const auto rows = static_cast<double>(block.num_row());
    const double noise = middle_of(block.sd), now = robust_rms(residual_of(block));
    // The parameters took some of it: n / (n - p) of the variance.
    const double without =
        robust_rms(left) *
        std::sqrt(rows / std::max(1.0, rows - static_cast<double>(num_parameter)));
    const double rms = without < now ? without : now;
    const double unexplained = std::sqrt(std::max(now * now - noise * noise, 0.0));
    range.amplitude = {0.01 * noise, max_residual_rms * std::max(noise, rms)};
    range.typical_amplitude =
        std::min(std::max(0.3 * noise, taken_by_the_fit * unexplained), range.amplitude[1]);
    std::tie(range.length_mm, range.typical_mm) =
        length_range(block.correlation_mm, grid.spacing_mm(), grid.extent_mm());
    std::tie(range.length_s, range.typical_s) =
        length_range(block.correlation_s, grid.spacing_s(), grid.extent_s());
    return range;
}

}  // namespace

std::vector<DiscrepancyRange> discrepancy_ranges(const std::vector<Parameter>& parameters,
                                                 const Prediction& prediction,
                                                 const NoiseModel& noise) {
    std::vector<DiscrepancyRange> ranges(prediction.blocks.size());
    for (Index b = 0; b < noise.num_block(); ++b) {
        const DataBlock& block = prediction.blocks[b];
        if (block.num_row() > 0)
            ranges[b] = range_of_block(block, noise.grid(b),
                                       left_without_field(parameters, prediction, noise, b),
                                       static_cast<Index>(parameters.size()));
    }
    return ranges;
}

double log_prior(const DiscrepancyRange& range, const Discrepancy& field) {
    const auto normal = [](double value, double median, double sd_ln) {
        const double z = std::log(value / median) / sd_ln;
        return -0.5 * z * z;
    };
    return normal(field.amplitude, range.typical_amplitude, prior_sd_ln_amplitude) +
           normal(field.length_mm, range.typical_mm, prior_sd_ln_length) +
           normal(field.length_s, range.typical_s, prior_sd_ln_length);
}

}  // namespace palpate
