// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "host/apps/aspirate/fit_page.hpp"
#include "host/apps/aspirate/median.hpp"
#include "host/apps/aspirate/tissue_search.hpp"
#include "host/apps/compute_options.hpp"
#include "host/apps/identify/identified_tree.hpp"
#include "host/apps/identify/mesh_check.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/tree_json.hpp"
#include "host/system/exit_codes.hpp"
#include "solver/base/error.hpp"
#include "solver/base/serial_blas.hpp"
#include "solver/base/tasks.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string name_of_model(const std::string& law, int num_terms) {
    return fmt::format("{}, {} relaxation term{}", law, num_terms, num_terms == 1 ? "" : "s");
}

constexpr double most_left_rest_mm = 0.05;
/// Of each number of the tissue: what outlines, the guess of the rest and contact at the rim leave
/// that no residual shows. Of films, those of another solver too (docs/aspiration.md).
constexpr double model_sd_ln = 0.02, model_sd_ln_of_stiffening = 0.04;
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

/// Empty if the model may be one of the film.
std::string misfit_of(const IdentifiedExperiment& found, double travel_mm) {
    const double left_mm = unexplained_mm(found.fit), part = left_mm / travel_mm;
    if (part <= most_unexplained) return "";
    return fmt::format(
        "The model leaves {:.2f} mm of the heights unexplained, {:.0f} % of the travel: it is none "
        "of this film, do not trust the values; {}.",
        left_mm, 100 * part, what_to_check);
}

/// For each number of the instrument that came out far from what was told of it, and for a surface
/// at rest that was not found.
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

/// One law with one number of relaxation terms.
TriedModel fit_one(const std::string& law, int num_terms, const AspirationSettings& settings,
                   const AspirationFitInput& input, const Suction& suction, const fs::path& inside,
                   const OptionValues& values, const ProgressSink& progress) {
    const SerialBlas
        serial;  // its matrices are small; threads of two fits would wait for each other
    const auto begin = std::chrono::steady_clock::now();
    const auto configure = [&](SimulationSettings& model) {
        take_tangent_options(values, model.newton);
    };
    TriedModel tried;
    tried.name = name_of_model(law, num_terms);
    const double travel_mm =
        *std::max_element(input.apex.travel_mm.begin(), input.apex.travel_mm.end());
    SearchedTissue searched = search_tissue(
        {settings, input, suction, tried.name, law, num_terms, inside, configure, jobs_of(values),
         progress},
        model_sds,
        [&](const Fit& fit) { return unexplained_mm(fit) > most_unexplained * travel_mm; });
    tried.experiment_toml = std::move(searched.experiment_toml);
    tried.experiment = std::move(searched.experiment);
    tried.found = std::make_shared<IdentifiedExperiment>(
        IdentifiedExperiment{.experiment = *tried.experiment});
    IdentifiedExperiment& found = *tried.found;
    found.fit = std::move(searched.fit);
    found.identified = std::move(searched.identified);
    found.num_simulation = searched.num_simulation;
    const Eigen::VectorXd model_sd = model_sds(tried.experiment->parameters());
    if (!searched.halved.empty())
        check_mesh(searched.halved, found, model_sd);
    else if (searched.is_believed)
        check_mesh(configure, found, progress, model_sd);
    found.misfit = misfit_of(found, travel_mm);
    tried.warnings = warnings_of(found, travel_mm);
    found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return tried;
}

}  // namespace

Eigen::VectorXd model_sds(const std::vector<Parameter>& parameters) {
    Eigen::VectorXd sds = Eigen::VectorXd::Zero(Eigen::Index(parameters.size()));
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        if (parameters[k].is_nuisance || parameters[k].transform != Transform::log) continue;
        const std::string& name = parameters[k].name;
        sds[Eigen::Index(k)] =
            name == "gamma" || name == "c2_kpa" ? model_sd_ln_of_stiffening : model_sd_ln;
    }
    return sds;
}

Suction suction_from(const OptionValues& values, const AspirationSettings& settings) {
    if (values.is_given("pressure") == settings.suction.has_value())
        throw Error(ErrorCode::invalid_argument,
                    settings.suction ? "suction is given twice; leave out --pressure, or the "
                                       "readings in [pressure]"
                                     : "there is no suction; give --pressure, or readings in "
                                       "[pressure]");
    return settings.suction ? *settings.suction : read_suction(values.path("pressure"));
}

Outcome fit_tissue(const AspirationSettings& settings, const Suction& suction,
                   const AspirationFitInput& input, const FilmOutlines* film,
                   const fs::path& inside, const OptionValues& values,
                   const ProgressSink& progress) {
    write_text_file(inside / points_file, input.points_csv());
    AspirationFit all{settings, input, suction, {}};
    const std::size_t num_terms = settings.relaxation_terms.size();
    all.models.resize(settings.laws.size() * num_terms);
    SharedProgress shared(progress);
    // A single one has all threads to itself.
    run_tasks(all.models.size(), jobs_of(values), shared, [&](std::size_t k) {
        all.models[k] =
            fit_one(settings.laws[k / num_terms], settings.relaxation_terms[k % num_terms],
                    settings, input, suction, inside, values, shared.sink());
    });
    const TriedModel& best = all.best();
    write_text_file(inside / "experiment.toml", best.experiment_toml);
    write_text_file(inside / "identified.toml",
                    best.experiment->model_text(best.found->fit.values, inside));
    write_text_file(inside / "fit.csv", fit_csv(*best.found));
    Outcome outcome{.result = fit_tree(all)};
    if (film) outcome.result.add(outlines_tree(*film, settings.instrument));
    write_text_file(inside / fit_result_file, tree_json(outcome.result));
    write_text_file(inside / "report.html", fit_page(all, outcome.result, film));
    outcome.text = fit_text(all);
    outcome.exit_code = best.found->distrust().empty() ? 0 : exit_code_not_converged;
    return outcome;
}

}  // namespace palpate
