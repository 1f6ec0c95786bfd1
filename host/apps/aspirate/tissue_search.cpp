// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/apps/identify/more_terms.hpp"
#include "host/apps/identify/resolution.hpp"
#include "host/estimate/corrected_problem.hpp"
#include "solver/base/error.hpp"
#include "solver/base/tasks.hpp"

namespace palpate {
namespace {

constexpr int most_rest_rounds = 4;
constexpr double settled_rest_mm = 0.01;
/// Until then a fit is only good for the surface: from here its quadratic does as well.
constexpr double gain_for_rest = 20;
constexpr int most_steps_for_rest = 12;  // of each search
/// At its end: what is left is a third of an sd, far less than models have wrong.
constexpr double gain_at_end = 0.05;
/// Steps there that should gain less than that, 1.4 sd, are solved without columns, which cost as
/// much again: of 20 films none had more than 0.051 left by columns that were made at its end,
/// and of 16 no interval was wider or narrower by more than 1.7 %.
constexpr double keeps_columns_at_end = 1;
constexpr int noise_rounds_for_rest = 2;
/// Of coarse cells that are corrected.
constexpr double gain_of_corrected = 1;
/// The same where laws are compared: far less than what makes a difference.
constexpr double gain_to_compare = 0.1;
/// Of coarse cells alone, which have far more wrong.
constexpr double gain_of_coarse = 5, share_of_coarse = 0.01;

/// The next fit begins where this one would end.
void take_start(const std::vector<Parameter>& parameters, const Fit& found, FitOptions& options) {
    options.start = quadratic_minimum(parameters, found, gain_for_rest);
    options.warm = found.prediction;
    options.discrepancy.given.clear();
    for (Index b = 0; b < found.noise->num_block(); ++b)
        options.discrepancy.given.push_back(found.noise->discrepancy(b));
}

}  // namespace

std::string name_of_model(const std::string& law, int num_terms) {
    return fmt::format("{}, {} relaxation term{}", law, num_terms, num_terms == 1 ? "" : "s");
}

TissueSearch::TissueSearch(TissueModel model, const ProgressSink& progress)
    : shared_(progress),
      model_(std::move(model)),
      sucked_{model_.input.rest.surface, model_.input.rest.seen_to_mm,
              model_.input.seen_later_to_mm, model_.input.steps, model_.input.start},
      halves_(model_.solving) {
    model_.solving.progress = shared_.sink();
    options_.gauss_newton.gain_tolerance = gain_at_end;
    // Tissue that does not stiffen holds the suction at the peak from the first on.
    if (model_.law == "neo-hookean-reduced")
        sucked_.start.mu_kpa = sucked_.start.peak_stiffness_kpa / young_over_mu;
    make_experiment();
}

void TissueSearch::make_experiment() {
    if (coarse_problem_) found_.num_simulation += coarse_problem_->num_simulation();
    coarse_problem_ = nullptr;
    found_.experiment_toml =
        experiment_text(model_.settings, sucked_, model_.suction, model_.law, model_.num_terms);
    found_.experiment = std::make_shared<const Experiment>(
        tissue_experiment(found_.experiment_toml, model_.inside));
    rest_errors_.clear();
    const std::vector<std::string>& paths = found_.experiment->paths();
    for (std::size_t k = 0; k < paths.size(); ++k)
        if (is_rest_error(paths[k])) rest_errors_.push_back(Index(k));
    coarse_problem_.reset(new ExperimentProblem(
        resized_problem(*found_.experiment, {double_cells, double_steps}, model_.solving)));
}

/// Tissue by coarse cells, with the instrument and the surface at rest as they are told: what such
/// cells have wrong would move these, from where the search may not come back. Where they say
/// nothing it begins at the guess.
void TissueSearch::find_start() {
    report(", on coarse cells");
    FitOptions rough = options_;
    const std::vector<Parameter>& parameters = found_.experiment->parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k)
        if (parameters[k].is_nuisance) rough.held.push_back(Index(k));
    rough.gauss_newton.gain_tolerance = gain_of_coarse;
    rough.gauss_newton.gain_share = share_of_coarse;
    rough.discrepancy.is_learned = false;  // it would learn what coarse cells have wrong
    rough.tries_other_starts = false;
    try {
        const Fit found = fit(*coarse_problem_, rough, model_.solving.progress);
        if (found.is_usable()) {
            options_.start = found.values;
            coarse_ = found.prediction;
        }
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        report_progress(model_.solving.progress, "fit", 0, std::string("not so: ") + error.what());
    }
}

FitOptions TissueSearch::rough_options() const {
    FitOptions rough = options_;
    rough.gauss_newton.gain_tolerance = gain_for_rest;
    rough.gauss_newton.max_steps = most_steps_for_rest;
    rough.discrepancy.max_rounds = noise_rounds_for_rest;
    return rough;
}

/// Near the start coarse cells do, once they say there what those of the experiment say. What that
/// took for one surface at rest is not good enough for the next one: carried over, it left surfaces
/// wrong by 0.03 mm. False, the start being as it was, where one of them says nothing or the search
/// finds no end.
bool TissueSearch::fit_corrected(const DataProblem& problem, double gain) {
    const ExperimentProblem& coarse = *coarse_problem_;
    if (options_.start.size() == 0) options_.start = starts_of(problem.parameters());
    try {
        const PredictionAttempt cheap =
            checked_prediction(coarse, options_.start, PredictedColumns::wanted, coarse_.get());
        if (!cheap.prediction) return false;
        const Prediction* warm = options_.warm ? options_.warm.get() : cheap.prediction.get();
        const PredictionAttempt exact =
            checked_prediction(problem, options_.start, PredictedColumns::none, warm);
        if (!exact.prediction) return false;
        const CorrectedProblem corrected(coarse, *exact.prediction, cheap.prediction);
        FitOptions rough = rough_options();
        rough.warm = nullptr;
        rough.tries_other_starts = false;
        rough.gauss_newton.gain_tolerance = gain;
        found_.fit = fit(corrected, rough, model_.solving.progress);
        if (found_.fit.ending == Ending::too_many_steps) return false;
        take_start(problem.parameters(), found_.fit, options_);
        coarse_ = CorrectedProblem::cheap_of(*found_.fit.prediction);
        options_.warm = moved_guess(*exact.prediction, *cheap.prediction, *coarse_, options_.start);
        if (!options_.warm) options_.warm = exact.prediction;
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        report_progress(model_.solving.progress, "fit", 0, std::string("not so: ") + error.what());
        return false;
    }
    is_near_ = true;
    return true;
}

void TissueSearch::fit_roughly(const DataProblem& problem) {
    report(", and the surface at rest");
    if (fit_corrected(problem, gain_of_corrected)) return;
    found_.fit = fit(problem, rough_options(), model_.solving.progress);
    take_start(problem.parameters(), found_.fit, options_);
    is_near_ = found_.fit.ending != Ending::too_many_steps;
}

bool TissueSearch::rest_is_settled() const {
    // A search that was cut off has not told yet.
    return found_.fit.ending != Ending::too_many_steps &&
           std::all_of(rest_errors_.begin(), rest_errors_.end(),
                       [&](Index k) { return std::abs(options_.start[k]) < settled_rest_mm; });
}

void TissueSearch::move_surface() {
    std::vector<double> error_mm;
    for (const Index k : rest_errors_) {
        error_mm.push_back(options_.start[k]);
        options_.start[k] = 0;
    }
    const double by_mm = move_rest(sucked_, error_mm);
    has_moved_ = by_mm >= settled_rest_mm;
    moved_mm_ += by_mm;
}

/// A fit for the surface at rest, which then moves by what was found of it. True once that is done
/// with.
bool TissueSearch::find_rest() {
    const bool is_first = ++num_round_ == 1;
    const bool is_rough = !rest_errors_.empty() && has_moved_ && num_round_ <= most_rest_rounds;
    const ExperimentProblem problem(*found_.experiment, model_.solving.configure,
                                    model_.solving.jobs, model_.solving.progress);
    if (is_rough)
        fit_roughly(problem);
    else if (is_first)
        fit_corrected(problem, gain_of_corrected);
    found_.num_simulation += problem.num_simulation();
    if (!is_rough || rest_is_settled()) return true;
    move_surface();
    make_experiment();
    return false;
}

/// Where a simpler model came to, its strongest relaxation term in two. False: it has not come
/// near.
bool TissueSearch::begin_at(const TissueSearch& simpler) {
    if (!simpler.is_near_) return false;
    sucked_ = simpler.sucked_;
    make_experiment();
    options_.start = start_with_more_terms(*simpler.found_.experiment, simpler.options_.start,
                                           *found_.experiment);
    options_.discrepancy.given = simpler.options_.discrepancy.given;
    if (simpler.coarse_) coarse_ = guess_for(*simpler.coarse_, options_.start);
    if (simpler.options_.warm) options_.warm = guess_for(*simpler.options_.warm, options_.start);
    return true;
}

/// Searches for several terms end in worse optima from the guess than from where one term ends.
bool TissueSearch::begin_at_one_term() {
    if (model_.num_terms < 2) return false;
    TissueModel of_one = model_;
    of_one.num_terms = 1;
    of_one.name = name_of_model(model_.law, 1);
    try {
        TissueSearch one(std::move(of_one), shared_.sink());
        one.approach();
        one.settle();
        const bool has_begun = begin_at(one);
        found_.num_simulation += one.found().num_simulation;
        return has_begun;
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        report_progress(model_.solving.progress, "fit", 0, std::string("not so: ") + error.what());
        return false;
    }
}

void TissueSearch::approach(const TissueSearch* simpler) {
    if (!(simpler ? begin_at(*simpler) : begin_at_one_term())) find_start();
    while (!has_rest_ && !is_near_) has_rest_ = find_rest();
}

bool TissueSearch::settle() {
    while (!has_rest_) has_rest_ = find_rest();
    const ExperimentProblem problem(*found_.experiment, model_.solving.configure,
                                    model_.solving.jobs, model_.solving.progress);
    const bool is_settled = fit_corrected(problem, gain_to_compare);
    found_.num_simulation += problem.num_simulation();
    return is_settled;
}

void TissueSearch::find_end() {
    while (!has_rest_) has_rest_ = find_rest();
    report("");
    problem_ = std::make_unique<const ExperimentProblem>(
        *found_.experiment, model_.solving.configure, model_.solving.jobs, model_.solving.progress);
    FitOptions last = options_;
    last.gauss_newton.keeps_columns_within = keeps_columns_at_end;
    found_.fit = fit(*problem_, last, model_.solving.progress);
}

SearchPlace TissueSearch::place() const {
    return problem_
               ? SearchPlace{found_.experiment, found_.fit.values, found_.fit.prediction, moved_mm_}
               : SearchPlace{found_.experiment, options_.start, options_.warm, moved_mm_};
}

/// What halves change is a difference of two models, so that the values at which both are solved
/// hardly matter: once a search has come near, it is found beside what is left of that.
void TissueSearch::find(bool halves_beside) {
    const SearchPlace near = place();
    const bool is_beside = halves_beside && is_near_ && TissueHalves::can_halve(near);
    if (is_beside) {
        report(", and halves of cells and steps");
        halved_at_ = near;
    }
    // From four threads on two for the search and two for both pairs, one after the other.
    constexpr std::size_t all_pairs = TissueHalves::num_pair;
    const std::size_t num_halving = !is_beside ? 0 : model_.solving.jobs < 4 ? all_pairs : 1;
    run_tasks(1 + num_halving, model_.solving.jobs, shared_, [&](std::size_t k) {
        if (k == 0) find_end();
        for (std::size_t pair = k; k > 0 && pair <= all_pairs; pair += num_halving)
            halves_.halve(pair - 1, near);
    });
}

void TissueSearch::weigh() {
    if (!found_.fit.prediction) return;
    IdentifyOptions weighing;
    weighing.skewness_tolerance = std::numeric_limits<double>::infinity();
    weighing.judges_far_ends = false;
    found_.identified = identify(*coarse_problem_, found_.fit, weighing, model_.solving.progress);
}

/// Coarse cells that say at the end what those of the experiment say there; null where they say
/// nothing.
std::unique_ptr<const DataProblem> TissueSearch::profile_guide() const {
    try {
        const PredictionAttempt cheap = checked_prediction(*coarse_problem_, found_.fit.values,
                                                           PredictedColumns::wanted, coarse_.get());
        if (!cheap.prediction) return nullptr;
        return std::make_unique<const CorrectedProblem>(*coarse_problem_, *found_.fit.prediction,
                                                        cheap.prediction);
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        return nullptr;
    }
}

void TissueSearch::judge() {
    found_.is_believed = !model_.is_no_model(found_.fit);
    const SearchPlace end = place();
    const bool is_halved =
        halved_at_.experiment && halves_.are_halved() && are_near(halved_at_, end);
    const bool must_halve = found_.is_believed && !is_halved && TissueHalves::can_halve(end);
    if (must_halve) {
        report(", halves of cells and steps");
        halves_.clear();
        run_tasks(TissueHalves::num_pair, model_.solving.jobs, shared_,
                  [&](std::size_t pair) { halves_.halve(pair, end); });
    }
    report_progress(model_.solving.progress, "intervals", 0, model_.name);
    IdentifyOptions judging;
    judging.jobs = model_.solving.jobs;
    judging.added_sd = model_.model_sd(found_.experiment->parameters());
    judging.guide = [this] { return profile_guide(); };
    if (!found_.is_believed) {
        judging.skewness_tolerance = std::numeric_limits<double>::infinity();
        judging.judges_far_ends = false;
    }
    found_.identified = identify(*problem_, found_.fit, judging, model_.solving.progress);
    if (found_.is_believed) found_.halved = halves_.pairs();
}

SearchedTissue TissueSearch::found() const {
    SearchedTissue found = found_;
    found.num_simulation += coarse_problem_->num_simulation() + halves_.num_simulation() +
                            (problem_ ? problem_->num_simulation() : 0);
    return found;
}

}  // namespace palpate
