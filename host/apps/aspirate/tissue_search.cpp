// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_search.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "host/apps/identify/experiment_problem.hpp"
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
/// Of coarse cells alone, which have far more wrong.
constexpr double gain_of_coarse = 5, share_of_coarse = 0.01;

using ModelSd = std::function<Eigen::VectorXd(const std::vector<Parameter>&)>;
using IsNoModel = std::function<bool(const Fit&)>;

/// For tissue and a surface at rest that differ by less, what halves change is nearly the same: of
/// 16 films one number moved by 0.1 sd against halves at the end, others by less than 0.06.
constexpr double near_ln = 0.1, near_rest_mm = 0.05;
/// Bulk modulus over Young's modulus at the peak where halves are solved, at most: of 16 films one
/// number moved by 0.14 sd against 500, others by less than 0.05, gamma nearly always down by 0.1
/// %; and Newton's method takes a third fewer steps.
constexpr double kappa_of_halves = 50;

/// Whether coarse cells may have an error where those of the experiment have none.
bool is_of_model(const Error& error) {
    return error.code() == ErrorCode::solve_failed || error.code() == ErrorCode::mesh_failed ||
           error.code() == ErrorCode::invalid_argument || error.code() == ErrorCode::input_unusable;
}

class Search {
public:
    Search(const TissueSearch& search, const ModelSd& model_sd, const IsNoModel& is_no_model)
        : search_(search),
          model_sd_(model_sd),
          is_no_model_(is_no_model),
          shared_(search.progress),
          progress_(shared_.sink()),
          sucked_{search.input.rest.surface, search.input.rest.seen_to_mm,
                  search.input.seen_later_to_mm, search.input.steps, search.input.start} {
        options_.gauss_newton.gain_tolerance = gain_at_end;
    }

    SearchedTissue run();

private:
    void make_experiment();
    using Resizing = bool (*)(SimulationSettings&);
    struct Halves {
        std::vector<Resizing> usual, halved;
    };
    static const std::array<Halves, 2> all_halves;
    ExperimentProblem resized_problem(
        const Experiment& experiment, const std::vector<Resizing>& resizings,
        double kappa_over_young = std::numeric_limits<double>::infinity()) const;
    void find_start();
    FitOptions rough_options() const;
    bool fit_corrected(const DataProblem& problem);
    void fit_roughly(const DataProblem& problem);
    void judge(const DataProblem& problem);
    /// What a search has come to, for halves beside what is left of it.
    struct Place {
        std::shared_ptr<const Experiment> experiment;
        Eigen::VectorXd values;
        std::shared_ptr<const Prediction> guess;
        double moved_mm = 0;  ///< of the surface at rest, until there
    };
    bool can_halve(const Place& place) const;
    std::shared_ptr<const Prediction> resized_prediction(const Place& place,
                                                         const std::vector<Resizing>& resizings,
                                                         const Prediction* warm);
    void halve(std::size_t k, const Place& place);
    bool has_stayed_near(const Place& place) const;
    bool rest_is_settled() const;
    void move_surface();
    bool find_rest();
    void end_search(bool has_rest);
    void report(const char* more) const {
        report_progress(progress_, "fit", 0, search_.name + more);
    }

    const TissueSearch& search_;
    const ModelSd& model_sd_;
    const IsNoModel& is_no_model_;
    SharedProgress shared_;
    ProgressSink progress_;  ///< of it
    SuckedBody sucked_;
    FitOptions options_;
    std::vector<Index> rest_errors_;  ///< places of `rest_error` among the numbers
    std::unique_ptr<const ExperimentProblem> coarse_problem_;  ///< `found_.experiment`'s
    std::shared_ptr<const Prediction> coarse_;                 ///< the last one there; may be null
    bool is_near_ = false;                 ///< whether a search has led to `options_.start`
    int num_round_ = 0;                    ///< of `find_rest`
    bool has_moved_ = true;                ///< the surface at rest, in the last one
    double moved_mm_ = 0;                  ///< it, in all of them together
    std::array<HalvedModel, 2> halved_;    ///< as `all_halves`
    std::atomic<int> num_simulation_ = 0;  ///< of the end
    SearchedTissue found_;
};

void Search::make_experiment() {
    if (coarse_problem_) found_.num_simulation += coarse_problem_->num_simulation();
    coarse_problem_ = nullptr;
    found_.experiment_toml =
        experiment_text(search_.settings, sucked_, search_.suction, search_.law, search_.num_terms);
    found_.experiment = std::make_shared<const Experiment>(
        tissue_experiment(found_.experiment_toml, search_.inside));
    rest_errors_.clear();
    const std::vector<std::string>& paths = found_.experiment->paths();
    for (std::size_t k = 0; k < paths.size(); ++k)
        if (is_rest_error(paths[k])) rest_errors_.push_back(Index(k));
    coarse_problem_.reset(
        new ExperimentProblem(resized_problem(*found_.experiment, {double_cells, double_steps})));
}

/// The experiment on cells, or time steps, of twice or half the size, with a bulk modulus of no
/// more than this over Young's modulus.
ExperimentProblem Search::resized_problem(const Experiment& experiment,
                                          const std::vector<Resizing>& resizings,
                                          double kappa_over_young) const {
    return {experiment,
            [configure = search_.configure, resizings,
             kappa_kpa = kappa_over_young *
                         search_.input.start.peak_stiffness_kpa](SimulationSettings& settings) {
                configure(settings);
                limit_bulk_modulus(kappa_kpa, settings);
                for (const Resizing resized : resizings)
                    if (!resized(settings))
                        throw Error(ErrorCode::solve_failed,
                                    "its cells and steps stay as they are");
            },
            search_.jobs, progress_};
}

/// The next fit begins where this one would end.
void take_start(const std::vector<Parameter>& parameters, const Fit& found, FitOptions& options) {
    options.start = quadratic_minimum(parameters, found, gain_for_rest);
    options.warm = found.prediction;
    options.discrepancy.given.clear();
    for (Index b = 0; b < found.noise->num_block(); ++b)
        options.discrepancy.given.push_back(found.noise->discrepancy(b));
}

/// Tissue by coarse cells, with the instrument and the surface at rest as they are told: what such
/// cells have wrong would move these, from where the search may not come back. Where they say
/// nothing it begins at the guess.
void Search::find_start() {
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
        const Fit found = fit(*coarse_problem_, rough, progress_);
        if (found.is_usable()) {
            options_.start = found.values;
            coarse_ = found.prediction;
        }
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        report_progress(progress_, "fit", 0, std::string("not so: ") + error.what());
    }
}

FitOptions Search::rough_options() const {
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
bool Search::fit_corrected(const DataProblem& problem) {
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
        rough.gauss_newton.gain_tolerance = gain_of_corrected;
        found_.fit = fit(corrected, rough, progress_);
        if (found_.fit.ending == Ending::too_many_steps) return false;
        take_start(problem.parameters(), found_.fit, options_);
        coarse_ = CorrectedProblem::cheap_of(*found_.fit.prediction);
        options_.warm = moved_guess(*exact.prediction, *cheap.prediction, *coarse_, options_.start);
        if (!options_.warm) options_.warm = exact.prediction;
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        report_progress(progress_, "fit", 0, std::string("not so: ") + error.what());
        return false;
    }
    is_near_ = true;
    return true;
}

void Search::fit_roughly(const DataProblem& problem) {
    report(", and the surface at rest");
    if (fit_corrected(problem)) return;
    found_.fit = fit(problem, rough_options(), progress_);
    take_start(problem.parameters(), found_.fit, options_);
    is_near_ = found_.fit.ending != Ending::too_many_steps;
}

bool Search::rest_is_settled() const {
    // A search that was cut off has not told yet.
    return found_.fit.ending != Ending::too_many_steps &&
           std::all_of(rest_errors_.begin(), rest_errors_.end(),
                       [&](Index k) { return std::abs(options_.start[k]) < settled_rest_mm; });
}

void Search::move_surface() {
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
bool Search::find_rest() {
    const bool is_first = ++num_round_ == 1;
    const bool is_rough = !rest_errors_.empty() && has_moved_ && num_round_ <= most_rest_rounds;
    const ExperimentProblem problem(*found_.experiment, search_.configure, search_.jobs, progress_);
    if (is_rough)
        fit_roughly(problem);
    else if (is_first)
        fit_corrected(problem);
    found_.num_simulation += problem.num_simulation();
    if (!is_rough || rest_is_settled()) return true;
    move_surface();
    make_experiment();
    return false;
}

void Search::judge(const DataProblem& problem) {
    report_progress(progress_, "intervals", 0, search_.name);
    IdentifyOptions judging;
    judging.jobs = search_.jobs;
    judging.added_sd = model_sd_(found_.experiment->parameters());
    found_.is_believed = !is_no_model_(found_.fit);
    if (!found_.is_believed) {
        judging.skewness_tolerance = std::numeric_limits<double>::infinity();
        judging.judges_far_ends = false;
    }
    found_.identified = identify(problem, found_.fit, judging, progress_);
}

/// What cells h / 2 change with time steps 2 dt, and steps dt / 2 with cells 2 h: what the one
/// changes hardly depends on the other, and this costs about half of (h / 2, dt) and (h, dt / 2).
/// The dearest first.
const std::array<Search::Halves, 2> Search::all_halves{
    {{{double_steps}, {halve_cells, double_steps}}, {{double_cells}, {halve_steps, double_cells}}}};

bool Search::can_halve(const Place& place) const {
    for (const Halves& halves : all_halves)
        for (const std::vector<Resizing>& resizings : {halves.usual, halves.halved}) {
            SimulationSettings settings = *place.experiment->at(place.values).simulation;
            for (const Resizing resized : resizings)
                if (!resized(settings)) return false;
        }
    return true;
}

/// Null where other cells or steps cannot do it: that is no reason to lose the fit.
std::shared_ptr<const Prediction> Search::resized_prediction(const Place& place,
                                                             const std::vector<Resizing>& resizings,
                                                             const Prediction* warm) {
    const ExperimentProblem resized =
        resized_problem(*place.experiment, resizings, kappa_of_halves);
    std::shared_ptr<const Prediction> made;
    try {
        if (warm)
            made =
                checked_prediction(resized, place.values, PredictedColumns::none, warm).prediction;
        // From a guess a load is given up early; without one it never is.
        if (!made)
            made = checked_prediction(resized, place.values, PredictedColumns::none, nullptr)
                       .prediction;
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
    }
    num_simulation_ += resized.num_simulation();
    return made;
}

void Search::halve(std::size_t k, const Place& place) {
    HalvedModel& pair = halved_[k];
    pair.usual = resized_prediction(place, all_halves[k].usual, place.guess.get());
    if (pair.usual) pair.halved = resized_prediction(place, all_halves[k].halved, pair.usual.get());
}

/// Whether the fit ended where what halves change is the same as at this place.
bool Search::has_stayed_near(const Place& place) const {
    if (moved_mm_ - place.moved_mm > near_rest_mm) return false;
    const std::vector<Parameter>& parameters = found_.experiment->parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const Parameter& one = parameters[k];
        const double apart = found_.fit.transformed[Eigen::Index(k)] -
                             to_transformed(one, place.values[Eigen::Index(k)]);
        const double most = one.transform == Transform::log ? near_ln
                            : one.has_prior()               ? one.sd
                                                            : 0.0;
        if (!(std::abs(apart) <= most)) return false;
    }
    return true;
}

/// What halves change is a difference of two models, so that the values at which both are solved
/// hardly matter: once a search has come near, it is found beside what is left of that.
///   has_rest   whether the surface at rest is found, too
void Search::end_search(bool has_rest) {
    const Place near{found_.experiment, options_.start, options_.warm, moved_mm_};
    const bool is_beside = is_near_ && can_halve(near);
    if (is_beside) report(", and halves of cells and steps");
    std::unique_ptr<const ExperimentProblem> problem;
    // From four threads on two for the search and two for both pairs, one after the other.
    const std::size_t num_halving = !is_beside ? 0 : search_.jobs < 4 ? all_halves.size() : 1;
    run_tasks(1 + num_halving, search_.jobs, shared_, [&](std::size_t k) {
        if (k > 0) {
            for (std::size_t pair = k - 1; pair < all_halves.size(); pair += num_halving)
                halve(pair, near);
            return;
        }
        while (!has_rest) has_rest = find_rest();
        report("");
        problem = std::make_unique<const ExperimentProblem>(*found_.experiment, search_.configure,
                                                            search_.jobs, progress_);
        FitOptions last = options_;
        last.gauss_newton.keeps_columns_within = keeps_columns_at_end;
        found_.fit = fit(*problem, last, progress_);
    });
    judge(*problem);
    const auto are_halved = [&] {
        return std::all_of(halved_.begin(), halved_.end(),
                           [](const HalvedModel& one) { return one.halved; });
    };
    const Place end{found_.experiment, found_.fit.values, found_.fit.prediction, moved_mm_};
    const bool is_near = is_beside && are_halved() && has_stayed_near(near);
    if (found_.is_believed && !is_near && can_halve(end)) {
        report(", with halves of cells and steps");
        halved_ = {};
        run_tasks(all_halves.size(), search_.jobs, shared_, [&](std::size_t k) { halve(k, end); });
    }
    found_.num_simulation += problem->num_simulation() + num_simulation_;
    if (found_.is_believed && are_halved()) found_.halved.assign(halved_.begin(), halved_.end());
}

SearchedTissue Search::run() {
    make_experiment();
    find_start();
    bool has_rest = false;
    while (!has_rest && !is_near_) has_rest = find_rest();
    end_search(has_rest);
    found_.num_simulation += coarse_problem_->num_simulation();
    return std::move(found_);
}

}  // namespace

SearchedTissue search_tissue(
    const TissueSearch& search,
    const std::function<Eigen::VectorXd(const std::vector<Parameter>&)>& model_sd,
    const std::function<bool(const Fit&)>& is_no_model) {
    return Search(search, model_sd, is_no_model).run();
}

}  // namespace palpate
