// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/map_estimate.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "host/apps/recover/inverse/map_steps.hpp"
#include "host/estimate/anderson.hpp"
#include "host/estimate/quasi_newton.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int remembered_steps = 8;
constexpr int needed_quiet_steps = 3;
constexpr int tolerated_stalls = 20;
constexpr int noise_rounds = 4;  // at each linearisation
constexpr double deeper = 0.1;   // of F, by which another valley must be
constexpr double same_end_mm = 1.0, same_end_sd = 0.5;

/// How much the objective may rise in an accelerated step: far below what a modulus would notice.
constexpr double acceptable_rise = 0.05;

bool differs(double a, double b) { return std::abs(a - b) >= 0.02 * std::max(a, b) && a != b; }

bool is_other(const NoiseLevel& a, const NoiseLevel& b) {
    return differs(a.scale, b.scale) || differs(a.contour_mm, b.contour_mm) ||
           std::abs(a.slice_share - b.slice_share) > 0.1;
}

/// The most probable moduli of a linearisation and what fits best with them.
struct BestModuli : Minimum {
    LinearisedProblem::Fit fit;
};

/// A change of ln E over the posterior standard deviation that the search knows.
Eigen::VectorXd in_standard_deviations(const Eigen::VectorXd& change, const BestModuli& best) {
    if (change.size() == 0) return change;
    const Eigen::VectorXd variance = best.hessian.inverse().diagonal();
    return change.cwiseQuotient(variance.cwiseAbs().cwiseSqrt());
}

std::vector<double> exponentials(std::vector<double> values) {
    for (double& value : values) value = std::exp(value);
    return values;
}

SearchPosition position_of(const BestModuli& best) {
    return {best.fit.driven, best.fit.frame, best.theta};
}

class Search : private MapSteps {
public:
    using MapSteps::MapSteps;

    MapEstimate run();
    MapEstimate run_from(const MapEstimate& earlier);
    MapEstimate run_near(const MapEstimate& earlier);

private:
    /// `is_scanned`: the moduli start at the best of a coarse scan, not at those of `state`.
    MapEstimate iterate(SearchState state, bool is_scanned);
    SearchState accelerated_step(const SearchState& from, const BestModuli& best,
                                 AndersonAcceleration& acceleration, bool& improved) const;
    SearchState blind_step(const SearchState& from, const BestModuli& best) const;
    BestModuli best_moduli(SearchState& state, bool is_scanned);
    bool settle_noise(SearchState& state, BestModuli& best, bool is_scanned);
    bool leaves_valley(SearchState& state);
    bool is_at_known_end(const SearchState& state) const;
    void record(int iteration, const SearchState& state, const BestModuli& best, double step);
    MapEstimate known_end(const SearchState& state) const;
    MapEstimate finish(const SearchState& state, const Termination& termination) const;

    Eigen::MatrixXd hessian_;  ///< of F, as far as the last linearisation knew it
    std::vector<IterationRecord> records_;
};

/// Tries the accelerated iterate first; the line search where that does not go down.
SearchState Search::accelerated_step(const SearchState& from, const BestModuli& best,
                                     AndersonAcceleration& acceleration, bool& improved) const {
    const Index n = model_->driven_dofs();
    const double determinant_change = best.end.log_determinant - best.start.log_determinant;
    const SearchPosition to = position_of(best);
    const Eigen::VectorXd point = from.scaled();
    const Eigen::VectorXd proposal = acceleration.next(point, to.scaled() - point);
    improved = true;
    if (acceleration.has_history()) {
        const Eigen::VectorXd theta = (proposal.tail(from.theta.size()) / search_mm_per_unit_ln)
                                          .cwiseMax(bounds_.lower)
                                          .cwiseMin(bounds_.upper);
        SearchState trial =
            state_at({proposal.head(n), proposal.segment<6>(n), theta}, from.counted);
        const double allowed = from.objective - 0.5 * determinant_change + acceptable_rise;
        if (std::isfinite(trial.objective) && trial.objective <= allowed) return trial;
        acceleration.reset();
    }
    double length = 0;
    SearchState next = search_line(from, to, determinant_change, length);
    improved = length > 0;
    return next;
}

/// Half the Gauss-Newton step, whatever the objective says: where closest points jump between the
/// facets of a target, the objective has kinks at which no line search goes down.
SearchState Search::blind_step(const SearchState& from, const BestModuli& best) const {
    return state_at(from.towards(position_of(best), 0.5), from.counted);
}

/// The most probable moduli with the surfaces linearised at `state`, whose own become those of a
/// scan if that is asked for.
BestModuli Search::best_moduli(SearchState& state, bool is_scanned) {
    const LinearisedProblem problem = linearise(state);
    check_cancelled(progress_);
    if (is_scanned)
        state = recounted(
            state_at({state.driven, state.frame, scan_grid(problem, bounds_)}, state.counted));
    check_cancelled(progress_);
    BestModuli best{minimise_bfgs(problem, state.theta, bounds_, hessian_), {}};
    best.fit = problem.fit(best.theta);
    hessian_ = best.hessian;
    return best;
}

/// Finds what is not given of the noise together with the moduli, the surfaces linearised where
/// they are: what a soft organ follows it does not leave, so that each depends on the other.
/// Returns whether the noise changed by more than 2 %.
bool Search::settle_noise(SearchState& state, BestModuli& best, bool is_scanned) {
    bool changed = false;
    // Only sigma_n: it may fall far, and surfaces that are not yet where they belong would all be
    // outliers, so it goes with the steps.
    const int most = options_.contour_mm ? 1 : noise_rounds;
    for (int round = 0; round < most; ++round) {
        const NoiseLevel next = level_for(best.fit);
        if (!is_other(next, noise_.level())) break;
        changed = true;
        noise_.set_level(next);
        state = recounted(state);
        best = best_moduli(state, is_scanned);
    }
    return changed;
}

/// Whether other moduli fit better than those of the valley where the search has ended, whose noise
/// was not known when the valley was chosen. They are taken if so.
bool Search::leaves_valley(SearchState& state) {
    const LinearisedProblem problem = linearise(state);
    const Eigen::VectorXd theta = scan_grid(problem, bounds_);
    const std::vector<double> values = problem.objectives({state.theta, theta});
    if (!(values[1] < values[0] - deeper)) return false;
    hessian_ = {};
    state = recounted(state_at({state.driven, state.frame, theta}, state.counted));
    return true;
}

bool Search::is_at_known_end(const SearchState& state) const {
    if (!options_.known_end) return false;
    const KnownEnd& known = *options_.known_end;
    return largest(state.driven - known.driven) < same_end_mm &&
           largest((state.theta - known.theta).cwiseQuotient(known.sd_ln)) < same_end_sd;
}

void Search::record(int iteration, const SearchState& state, const BestModuli& best, double step) {
    IterationRecord entry;
    entry.iteration = iteration;
    entry.objective = state.objective + 0.5 * best.end.log_determinant;
    entry.gradient_norm = best.gradient_norm;
    entry.step = step;
    std::string text;
    for (Index k = 0; k < state.theta.size(); ++k) {
        entry.stiffness_kpa.push_back(std::exp(state.theta[k]));
        text += fmt::format(" {:.4g} kPa,", entry.stiffness_kpa.back());
    }
    records_.push_back(entry);
    report_progress(
        progress_, "searching", -1,
        fmt::format("iteration {}:{} step {:.2g} mm, objective {:.2f}, both images' contours "
                    "{:.2f} mm off together, sigma_n x {:.2f}",
                    iteration, text, step, entry.objective, noise_.level().contour_mm,
                    noise_.level().scale));
}

MapEstimate Search::run() {
    Eigen::VectorXd theta(unknowns_.size());
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
        theta[k] = options_.start_kpa > 0 ? std::log(options_.start_kpa) : unknowns_[k].mean;
    }
    noise_.set_level(first_level());
    SearchState state = state_at(
        {Eigen::VectorXd::Zero(model_->driven_dofs()), FrameMotion::Zero(), theta}, nullptr);
    const bool are_walls_open = can_fit_walls(state);
    state = are_walls_open ? settle_first(state) : settle_walls(state);
    noise_.take_terraces(state.seen);
    state = recounted(std::move(state));
    if (are_walls_open) state = settle_walls(with_fitted_walls(std::move(state)));
    return iterate(std::move(state), true);
}

MapEstimate Search::run_from(const MapEstimate& earlier) {
    noise_ = *earlier.noise;
    take_walls(earlier.walls);
    held_ = earlier.counted;
    return iterate(state_at({earlier.driven, earlier.frame, earlier.theta}, held_), false);
}

MapEstimate Search::run_near(const MapEstimate& earlier) {
    noise_ = *earlier.noise;
    take_walls(earlier.walls);
    if (options_.reach > 1) {
        const auto reach = Eigen::ArrayXd::Constant(earlier.theta.size(), std::log(options_.reach));
        bounds_.lower = bounds_.lower.cwiseMax((earlier.theta.array() - reach).matrix());
        bounds_.upper = bounds_.upper.cwiseMin((earlier.theta.array() + reach).matrix());
    }
    return iterate(state_at({earlier.driven, earlier.frame, earlier.theta}, nullptr), false);
}

MapEstimate Search::iterate(SearchState state, bool is_scanned) {
    Termination termination{
        false, fmt::format("{} iterations were not enough", options_.max_iterations), 0};
    AndersonAcceleration acceleration(remembered_steps);
    int quiet_steps = 0, stalls = 0;
    // Half steps that no line search guards may climb. Where contours are off, outliers are counted
    // anew at each state, and objectives of two states do not compare.
    const bool keeps_lowest = options_.contour_mm == 0;
    std::optional<SearchState> lowest;  // since steps were refused, the noise the same throughout
    double lowest_objective = 0;
    bool is_checked = !is_scanned || unknowns_.empty();  // for deeper valleys
    for (int k = 1; k <= options_.max_iterations; ++k) {
        const bool is_noise_open = k < options_.noise_iterations && !held_;
        BestModuli best = best_moduli(state, k == 1 && is_scanned);
        const bool is_noise_new = is_noise_open && settle_noise(state, best, k == 1 && is_scanned);
        if (is_noise_new) acceleration.reset();
        const double moved = largest(best.fit.driven - state.driven);
        const Eigen::VectorXd theta_before = state.theta;
        bool improved = true;
        state = accelerated_step(state, best, acceleration, improved);
        if (is_noise_open) noise_.take_terraces(state.seen);
        state = recounted(std::move(state));
        record(k, state, best, moved);
        termination.iterations = k;
        if (is_noise_new || is_noise_open) lowest.reset();
        if (keeps_lowest && (lowest ? records_.back().objective < lowest_objective : !improved)) {
            lowest = state;
            lowest_objective = records_.back().objective;
        }
        if (k + 1 == options_.noise_iterations && is_noise_open && is_scanned) {
            state = with_fitted_walls(state);
            acceleration.reset();
            lowest.reset();
            continue;
        }
        if (is_noise_new) continue;
        if (!is_noise_open && is_at_known_end(state)) return known_end(state);
        // A step that the line search refused stays where it was: what was proposed counts then.
        const Eigen::VectorXd change = (improved ? state.theta : best.theta) - theta_before;
        const double changed = largest(in_standard_deviations(change, best));
        const double objective_changed =
            k == 1 ? 1e300 : std::abs(records_[k - 1].objective - records_[k - 2].objective);
        const bool is_quiet =
            changed < options_.modulus_tolerance_sd &&
            objective_changed < options_.objective_tolerance_per_row * observations_.num_rows();
        quiet_steps = is_quiet ? quiet_steps + 1 : 0;
        if (quiet_steps == needed_quiet_steps) {
            if (!std::exchange(is_checked, true) && leaves_valley(state)) {
                acceleration.reset();
                lowest.reset();
                quiet_steps = 0;
                continue;
            }
            termination.converged = true;
            termination.reason = fmt::format(
                "{} steps in a row changed no modulus by more than {:.2g} of its standard "
                "deviation and "
                "the log posterior by less than {:.2g} per surface point",
                needed_quiet_steps, options_.modulus_tolerance_sd,
                options_.objective_tolerance_per_row);
            break;
        }
        if (!improved && ++stalls > tolerated_stalls) {
            termination.reason = "the line search found no lower point, several times over";
            break;
        }
        if (!improved) state = recounted(blind_step(state, best));
    }
    if (lowest && lowest_objective <= records_.back().objective) state = *std::move(lowest);
    if (!std::isfinite(state.objective))
        throw Error(
            ErrorCode::solve_failed,
            "the search ended where the objective is not a finite number; check the settings "
            "for extreme values");
    return finish(state, termination);
}

/// Where another search has been, so that it is told no more of.
MapEstimate Search::known_end(const SearchState& state) const {
    MapEstimate estimate;
    estimate.theta = state.theta;
    estimate.termination = {true, "another search has ended there", int(records_.size())};
    return estimate;
}

MapEstimate Search::finish(const SearchState& state, const Termination& termination) const {
    MapEstimate estimate;
    estimate.driven = state.driven;
    estimate.frame = state.frame;
    estimate.observed = state.observed;
    estimate.unknown = unknowns_;
    estimate.theta = state.theta;
    if (are_walls_fitted_) {
        estimate.walls = walls_;
        estimate.response = model_;
    }
    estimate.noise_level = noise_.level();
    estimate.noise = std::make_shared<SurfaceNoise>(noise_);
    estimate.records = records_;
    estimate.termination = termination;
    estimate.posterior = std::make_shared<LinearisedProblem>(linearise(state));
    const LinearisedProblem& problem = *estimate.posterior;
    estimate.counted = state.counted;
    // The noise's own determinant is shared, but for what outliers make of it at each estimate.
    estimate.objective =
        state.objective + 0.5 * (problem.evaluate(state.theta, false).log_determinant -
                                 problem.noise_log_determinant());
    take_uncertainty(problem, options_, estimate, progress_);
    return estimate;
}

}  // namespace

void take_uncertainty(const Objective& problem, const MapOptions& options, MapEstimate& estimate,
                      const ProgressSink& progress) {
    const Eigen::VectorXd& theta = estimate.theta;
    const Bounds bounds = map_bounds(options, problem.num_unknown());
    check_cancelled(progress);
    estimate.covariance = laplace_covariance(problem, theta);
    check_cancelled(progress);
    const Eigen::MatrixXd information = problem.seen_information(theta);
    estimate.seen_sd_ln = seen_sd(information, problem.unknowns());
    estimate.sensitivity = scaled_sensitivity(information, problem.unknowns());
    estimate.profiles.clear();
    estimate.interval_kpa.clear();
    estimate.excluded_ends.clear();
    for (Index k = 0; k < problem.num_unknown(); ++k) {
        check_cancelled(progress);
        const Profile profile = profile_of(problem, theta, estimate.covariance, k);
        estimate.profiles.push_back(
            {problem.unknowns()[k].object, exponentials(profile.value), profile.objective});
        const auto [low, high] = profile_interval(profile, theta[k]);
        estimate.interval_kpa.push_back({std::exp(low), std::exp(high)});
        check_cancelled(progress);
        estimate.excluded_ends.push_back(
            excluded_ends(problem, theta, estimate.covariance, k, bounds));
    }
}

MapEstimate map_estimate(const ResponseModel& model, const WallPrior& walls,
                         const SurfaceObservations& observations,
                         const std::vector<Unknown>& unknowns, const MapOptions& options,
                         const ProgressSink& progress) {
    return Search(model, walls, observations, unknowns, options, progress).run();
}

MapEstimate map_estimate_from(const MapEstimate& earlier, const ResponseModel& model,
                              const WallPrior& walls, const SurfaceObservations& observations,
                              const std::vector<Unknown>& unknowns, const MapOptions& options,
                              const ProgressSink& progress) {
    return Search(model, walls, observations, unknowns, options, progress).run_from(earlier);
}

MapEstimate map_estimate_near(const MapEstimate& earlier, const ResponseModel& model,
                              const WallPrior& walls, const SurfaceObservations& observations,
                              const std::vector<Unknown>& unknowns, const MapOptions& options,
                              const ProgressSink& progress) {
    return Search(model, walls, observations, unknowns, options, progress).run_near(earlier);
}

}  // namespace palpate
