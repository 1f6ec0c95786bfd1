// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_misfit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "host/apps/aspirate/median.hpp"
#include "host/apps/aspirate/tissue_experiment.hpp"

namespace palpate {
namespace {

constexpr double most_left_rest_mm = 0.05;
/// Of the travel, that a model may leave unexplained: without a word, and at all.
constexpr double much_unexplained = 0.03, most_unexplained = 0.05;
constexpr double sd_over_median = 1.4826;
constexpr const char* what_to_check =
    "look at the outlines, and check base_row_px, tissue, axis_column_px, pixels, the unit of "
    "suction and the times of film and suction, then try other laws";
constexpr double most_instrument_sd = 3;  ///< of its prior, within which the instrument is believed

/// What the model leaves beyond the noise in all but the worst tenth of the frames, mm: of each
/// frame
///     sqrt((1.48 median |r|)^2 - (median sd)^2),
/// so that a stain that was taken for tissue here or there says nothing about the model.
double unexplained_mm(const Fit& fit) {
    const DataBlock& block = fit.prediction->blocks.front();
    std::map<double, std::pair<std::vector<double>, std::vector<double>>> frames;
    for (Index row = 0; row < block.num_row(); ++row) {
        auto& [away, noise] = frames[block.time_s[row]];
        away.push_back(std::abs(block.measured[row] - block.predicted[row]));
        noise.push_back(block.sd[row]);
    }
    std::vector<double> left;
    for (auto& [time_s, frame] : frames) {
        const double away = sd_over_median * median(frame.first), noise = median(frame.second);
        left.push_back(std::sqrt(std::max(0.0, away * away - noise * noise)));
    }
    std::sort(left.begin(), left.end());
    return left[(left.size() - 1) * 9 / 10];
}

}  // namespace

bool is_no_model(const Fit& fit, double travel_mm) {
    return unexplained_mm(fit) > most_unexplained * travel_mm;
}

std::string misfit_of(const Fit& fit, double travel_mm) {
    const double left_mm = unexplained_mm(fit), part = left_mm / travel_mm;
    if (part <= most_unexplained) return "";
    return fmt::format(
        "The model leaves {:.2f} mm of the heights unexplained, {:.0f} % of the travel: it is none "
        "of this film, do not trust the values; {}.",
        left_mm, 100 * part, what_to_check);
}

std::vector<std::string> warnings_of(const IdentifiedExperiment& found, double travel_mm) {
    std::vector<std::string> warnings;
    const double much_mm = unexplained_mm(found.fit), part = much_mm / travel_mm;
    if (part > much_unexplained && part <= most_unexplained)
        warnings.push_back(
            fmt::format("the model leaves {:.3f} mm unexplained, {:.1f} % of the travel; {}",
                        much_mm, 100 * part, what_to_check));
    double left_mm = 0;
    for (std::size_t k = 0; k < found.identified.parameters.size(); ++k) {
        const IdentifiedParameter& one = found.identified.parameters[k];
        const Parameter& told = one.parameter;
        if (is_rest_error(found.experiment.paths()[k])) {
            left_mm = std::max(left_mm, std::abs(found.fit.values[Eigen::Index(k)]));
            continue;
        }
        if (!told.is_nuisance || !told.has_prior()) continue;
        const double sds =
            std::abs(to_transformed(told, one.value) - to_transformed(told, told.median)) / told.sd;
        if (sds > most_instrument_sd)
            warnings.push_back(fmt::format(
                "{} came out {:.1f} sd from what was expected of it; check it, base_row_px "
                "and the pixels, and do not believe the tissue before",
                label_of(told), sds));
    }
    if (left_mm > most_left_rest_mm)
        warnings.push_back(
            fmt::format("the surface at rest behind the rim is guessed wrong by {:.2f} mm; film "
                        "tissue that stands higher, take a thinner rim, or check base_row_px",
                        left_mm));
    return warnings;
}

}  // namespace palpate
