// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/map_estimate.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/inverse/anderson.hpp"
#include "host/inverse/modulus_search.hpp"
#include "host/inverse/surface_noise.hpp"
#include "host/inverse/uncertainty.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int remembered_steps = 8;
constexpr int needed_quiet_steps = 3;
constexpr int tolerated_stalls = 8;
/// What voxels leave of sigma_n once terraces and contours are told apart from it.
constexpr double independent_part = 0.45;
constexpr double first_contour_mm = 0.3, least_contour_mm = 0.05, most_contour_mm = 1.5;
constexpr double mm_per_unit_ln = 10.0;  // weight of ln E beside one driven component, in Anderson

/// How much the objective may rise in an accelerated step: far below what a modulus would notice.
constexpr double acceptable_rise = 0.05;

double largest(const Eigen::VectorXd& vector) {
    return vector.size() == 0 ? 0.0 : vector.cwiseAbs().maxCoeff();
}

bool differs(double a, double b) { return std::abs(a - b) >= 0.02 * std::max(a, b) && a != b; }

/// A change of ln E over the posterior standard deviation that the search knows.
Eigen::VectorXd in_standard_deviations(const Eigen::VectorXd& change, const ModulusMinimum& best) {
    if (change.size() == 0) return change;
    const Eigen::VectorXd variance = best.hessian.inverse().diagonal();
    return change.cwiseQuotient(variance.cwiseAbs().cwiseSqrt());
}

ModulusBounds all_bounds(const MapOptions& options, Index num_unknown) {
    return same_bounds(num_unknown, std::log(options.smallest_kpa), std::log(options.largest_kpa));
}

/// Rows that the objective is over. Held through a step, so that no step pays by moving surfaces to
/// where the target does not show them.
using Counted = std::vector<std::uint8_t>;

struct State {
    Eigen::VectorXd driven, observed, theta;
    ObservedState seen;
    double objective = 0;  ///< nonlinear, without the determinant
};

class Search {
public:
    Search(const ResponseModel& model, const WallPrior& walls,
           const SurfaceObservations& observations, const std::vector<ModulusPrior>& priors,
           const MapOptions& options, const ProgressSink& progress)
        : model_(model),
          walls_(walls),
          observations_(observations),
          noise_(observations),
          priors_(priors),
          options_(options),
          progress_(progress),
          bounds_(all_bounds(options, static_cast<Index>(priors.size()))) {}

    MapEstimate run();
    MapEstimate run_from(const MapEstimate& earlier);
    MapEstimate run_near(const MapEstimate& earlier);

private:
    /// `is_scanned`: the moduli start at the best of a coarse scan, not at those of `state`.
    MapEstimate iterate(State state, bool is_scanned);
    State state_at(const Eigen::VectorXd& driven, const Eigen::VectorXd& theta,
                   const Counted& counted) const;
    double objective_of(const State& state, const Counted& counted) const;
    /// The same place, its objective over what is seen there.
    State recounted(State state) const;
    std::vector<LinearRow> rows_of(const State& state) const;
    LinearisedProblem linearise(const State& state) const;
    State settle_walls(State state) const;
    State search_line(const State& from, const Eigen::VectorXd& driven,
                      const Eigen::VectorXd& theta, double determinant_change,
                      double& length) const;
    State accelerated_step(const State& from, const ModulusMinimum& best,
                           AndersonAcceleration& acceleration, bool& improved) const;
    State blind_step(const State& from, const ModulusMinimum& best) const;
    double first_contour_error() const;
    bool has_contour_error() const { return first_contour_error() > 0; }
    double scale_beside_contours() const;
    void start_noise();
    bool update_noise(const ModulusMinimum& best, const State& state);
    NoiseLevel level_without_contours(const ModulusObjective::Fit& fit) const;
    NoiseLevel level_with_contours(const ModulusObjective::Fit& fit) const;
    void record(int iteration, const State& state, const ModulusMinimum& best, double step);
    MapEstimate finish(const State& state, const Termination& termination) const;

    const ResponseModel& model_;
    const WallPrior& walls_;
    const SurfaceObservations& observations_;
    SurfaceNoise noise_;
    /// Of an earlier estimate near which the search starts: its noise is held, and these rows are
    /// counted whatever is seen. Empty: a fresh search.
    Counted held_;
    const std::vector<ModulusPrior>& priors_;
    const MapOptions& options_;
    const ProgressSink& progress_;
    ModulusBounds bounds_;
    std::vector<IterationRecord> records_;
};

State Search::state_at(const Eigen::VectorXd& driven, const Eigen::VectorXd& theta,
                       const Counted& counted) const {
    std::vector<Index> unknown;
    for (const auto& prior : priors_) unknown.push_back(prior.region);
    const auto kpa = model_.moduli(unknown, theta);
    State state{driven, model_.observed_displacement(kpa, driven), theta, {}, 0};
    state.seen = observations_.evaluate(state.driven, state.observed);
    if (!held_.empty()) state.seen.seen = held_;
    state.objective = objective_of(state, counted);
    return state;
}

double Search::objective_of(const State& state, const Counted& counted) const {
    double objective = noise_.misfit(state.seen.residual_mm, counted) + walls_.energy(state.driven);
    for (std::size_t k = 0; k < priors_.size(); ++k) {
        const double z = (state.theta[k] - priors_[k].mean_ln) / priors_[k].sd_ln;
        objective += 0.5 * z * z;
    }
    return objective;
}

State Search::recounted(State state) const {
    state.objective = objective_of(state, state.seen.seen);
    return state;
}

std::vector<LinearRow> Search::rows_of(const State& state) const {
    return noise_.linear_rows(state.seen);
}

LinearisedProblem Search::linearise(const State& state) const {
    check_cancelled(progress_);
    return LinearisedProblem(model_, walls_, rows_of(state), state.driven, state.observed, priors_);
}

/// Brings the driven walls near their targets with the moduli held, before anything is concluded
/// from the observed surfaces.
State Search::settle_walls(State state) const {
    for (int k = 0; k < 6; ++k) {
        double length = 0;
        const WallPosterior walls(walls_, rows_of(state), state.driven);
        const State next = search_line(state, walls.mean(), state.theta, 0.0, length);
        const double moved = largest(next.driven - state.driven);
        state = recounted(next);
        if (length == 0 || moved < 0.1) break;
    }
    return state;
}

/// Line search on the nonlinear objective, with the determinant of this linearisation (taken as
/// linear along the step). Gauss-Newton leaves out how the surfaces curve, so in some directions it
/// goes twice too far, step after step: a parabola through three points finds the right length.
State Search::search_line(const State& from, const Eigen::VectorXd& driven,
                          const Eigen::VectorXd& theta, double determinant_change,
                          double& length) const {
    State best = from;
    double lowest = from.objective;
    length = 0;
    const auto offer = [&](double t) {
        check_cancelled(progress_);
        State trial = state_at(from.driven + t * (driven - from.driven),
                               from.theta + t * (theta - from.theta), from.seen.seen);
        const double value = trial.objective + t * 0.5 * determinant_change;
        if (std::isfinite(value) && value <= lowest) {
            lowest = value;
            length = t;
            best = std::move(trial);
        }
        return value;
    };
    const double whole = offer(1.0);
    const double half = offer(0.5);
    const double bend = 2.0 * (whole + from.objective - 2.0 * half);
    const double slope = 4.0 * half - 3.0 * from.objective - whole;
    if (bend > 0 && slope < 0) offer(std::clamp(-0.5 * slope / bend, 0.1, 1.5));
    for (double t = 0.25; length == 0 && t > 1e-3; t *= 0.5) offer(t);
    return best;
}

/// Tries the accelerated iterate first; the line search where that does not go down.
State Search::accelerated_step(const State& from, const ModulusMinimum& best,
                               AndersonAcceleration& acceleration, bool& improved) const {
    const Index n = model_.driven_dofs();
    const double determinant_change = best.log_determinant - best.start_log_determinant;
    Eigen::VectorXd point(n + from.theta.size()), step(point.size());
    point << from.driven, mm_per_unit_ln * from.theta;
    step << best.fit.driven - from.driven, mm_per_unit_ln * (best.theta - from.theta);
    const Eigen::VectorXd proposal = acceleration.next(point, step);
    improved = true;
    if (acceleration.has_history()) {
        const Eigen::VectorXd theta = (proposal.tail(from.theta.size()) / mm_per_unit_ln)
                                          .cwiseMax(bounds_.lower_ln)
                                          .cwiseMin(bounds_.upper_ln);
        State trial = state_at(proposal.head(n), theta, from.seen.seen);
        const double allowed = from.objective - 0.5 * determinant_change + acceptable_rise;
        if (std::isfinite(trial.objective) && trial.objective <= allowed) return trial;
        acceleration.reset();
    }
    double length = 0;
    State next = search_line(from, best.fit.driven, best.theta, determinant_change, length);
    improved = length > 0;
    return next;
}

/// Half the Gauss-Newton step, whatever the objective says: where closest points jump between the
/// facets of a target, the objective has kinks at which no line search goes down.
State Search::blind_step(const State& from, const ModulusMinimum& best) const {
    return state_at(0.5 * (from.driven + best.fit.driven), 0.5 * (from.theta + best.theta),
                    from.seen.seen);
}

/// The smallest part of sigma_n that the search may come to trust.
double Search::scale_beside_contours() const {
    return std::max(independent_part, options_.smallest_noise_scale);
}

double Search::first_contour_error() const {
    return options_.contour_mm.value_or(options_.estimate_noise ? first_contour_mm : 0.0);
}

void Search::start_noise() {
    if (has_contour_error()) noise_.start({scale_beside_contours(), first_contour_error()});
}

/// Terraces are taken where the surfaces have come to, and what is not given is found. Returns
/// whether it changed by more than 2 %.
bool Search::update_noise(const ModulusMinimum& best, const State& state) {
    NoiseLevel next = noise_.level();
    if (options_.estimate_noise) {
        next =
            has_contour_error() ? level_with_contours(best.fit) : level_without_contours(best.fit);
    }
    const bool changed = differs(next.scale, noise_.level().scale) ||
                         differs(next.contour_mm, noise_.level().contour_mm);
    noise_.update(changed ? next : noise_.level(), state.seen);
    return changed;
}

/// sigma_n^2 such that the observed residual has the size that its own model predicts:
/// E[r^T R^-1 r] = tr(R C^-1) for r = R C^-1 e.
NoiseLevel Search::level_without_contours(const ModulusObjective::Fit& fit) const {
    NoiseLevel level = noise_.level();
    if (fit.effective_rows < 1) return level;
    const double factor = std::clamp(std::sqrt(fit.weighted_misfit / fit.effective_rows), 0.5, 2.0);
    level.scale = std::clamp(level.scale * factor, options_.smallest_noise_scale, 20.0);
    return level;
}

/// The contours' error such that E[r^T r] = tr(R C^-1 R). Without weights: those of R^-1 ask the
/// shortest waves, where the kernel is least certain and moduli do not show.
NoiseLevel Search::level_with_contours(const ModulusObjective::Fit& fit) const {
    NoiseLevel level{scale_beside_contours(), noise_.level().contour_mm};
    if (options_.contour_mm || !(fit.expected_misfit_mm2 > 0)) return level;
    level.contour_mm = std::clamp(noise_.contour_mm_for(fit.misfit_mm2 / fit.expected_misfit_mm2),
                                  least_contour_mm, most_contour_mm);
    return level;
}

void Search::record(int iteration, const State& state, const ModulusMinimum& best, double step) {
    IterationRecord entry;
    entry.iteration = iteration;
    entry.objective = state.objective + 0.5 * best.log_determinant;
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
        fmt::format("iteration {}:{} step {:.2g} mm, objective {:.2f}, contours {:.2f} mm off",
                    iteration, text, step, entry.objective, noise_.level().contour_mm));
}

MapEstimate Search::run() {
    Eigen::VectorXd theta(priors_.size());
    for (std::size_t k = 0; k < priors_.size(); ++k) {
        theta[k] = options_.start_kpa > 0 ? std::log(options_.start_kpa) : priors_[k].mean_ln;
    }
    const Counted all(observations_.num_rows(), 1);
    start_noise();
    State state =
        settle_walls(recounted(state_at(Eigen::VectorXd::Zero(model_.driven_dofs()), theta, all)));

    noise_.update(noise_.level(), state.seen);
    return iterate(recounted(state), true);
}

MapEstimate Search::run_from(const MapEstimate& earlier) {
    noise_ = *earlier.noise;
    held_ = earlier.counted;
    return iterate(state_at(earlier.driven, earlier.theta, held_), false);
}

MapEstimate Search::run_near(const MapEstimate& earlier) {
    noise_ = *earlier.noise;
    if (options_.reach > 1) {
        const auto reach = Eigen::ArrayXd::Constant(earlier.theta.size(), std::log(options_.reach));
        bounds_.lower_ln = bounds_.lower_ln.cwiseMax((earlier.theta.array() - reach).matrix());
        bounds_.upper_ln = bounds_.upper_ln.cwiseMin((earlier.theta.array() + reach).matrix());
    }
    return iterate(recounted(state_at(earlier.driven, earlier.theta, earlier.counted)), false);
}

MapEstimate Search::iterate(State state, bool is_scanned) {
    Termination termination{
        false, fmt::format("{} iterations were not enough", options_.max_iterations), 0};
    AndersonAcceleration acceleration(remembered_steps);
    Eigen::MatrixXd hessian;
    int quiet_steps = 0, stalls = 0;
    for (int k = 1; k <= options_.max_iterations; ++k) {
        const LinearisedProblem problem = linearise(state);
        check_cancelled(progress_);
        const Eigen::VectorXd start =
            k == 1 && is_scanned ? scan_moduli(problem, bounds_) : Eigen::VectorXd(state.theta);
        if (k == 1) state = recounted(state_at(state.driven, start, state.seen.seen));
        check_cancelled(progress_);
        const ModulusMinimum best = minimise_moduli(problem, start, bounds_, hessian);
        hessian = best.hessian;
        const double moved = largest(best.fit.driven - state.driven);
        const Eigen::VectorXd theta_before = state.theta;
        bool improved = true;
        state = recounted(accelerated_step(state, best, acceleration, improved));
        record(k, state, best, moved);
        termination.iterations = k;
        if (k < options_.noise_iterations && held_.empty()) {
            const bool changed = update_noise(best, state);
            state = recounted(state);
            if (changed) {
                acceleration.reset();
                continue;
            }
        }
        const double changed = largest(in_standard_deviations(state.theta - theta_before, best));
        const double objective_changed =
            k == 1 ? 1e300 : std::abs(records_[k - 1].objective - records_[k - 2].objective);
        const bool is_quiet =
            changed < options_.modulus_tolerance_sd &&
            objective_changed < options_.objective_tolerance_per_row * observations_.num_rows();
        quiet_steps = is_quiet ? quiet_steps + 1 : 0;
        if (quiet_steps == needed_quiet_steps) {
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
    if (!std::isfinite(state.objective))
        throw Error(
            ErrorCode::solve_failed,
            "the search ended where the objective is not a finite number; check the settings "
            "for extreme values");
    return finish(state, termination);
}

MapEstimate Search::finish(const State& state, const Termination& termination) const {
    MapEstimate estimate;
    estimate.driven = state.driven;
    estimate.observed = state.observed;
    estimate.unknown = priors_;
    estimate.theta = state.theta;
    estimate.noise_level = noise_.level();
    estimate.noise = std::make_shared<SurfaceNoise>(noise_);
    estimate.records = records_;
    estimate.termination = termination;
    estimate.posterior = std::make_shared<LinearisedProblem>(linearise(state));
    const LinearisedProblem& problem = *estimate.posterior;
    estimate.counted = state.seen.seen;
    // The noise's own determinant is shared, but for what outliers make of it at each estimate.
    estimate.objective =
        state.objective + 0.5 * (problem.evaluate(state.theta, false).log_determinant -
                                 problem.noise_log_determinant());
    take_uncertainty(problem, options_, estimate, progress_);
    return estimate;
}

}  // namespace

void take_uncertainty(const LinearisedProblem& problem, const MapOptions& options,
                      MapEstimate& estimate, const ProgressSink& progress) {
    const Eigen::VectorXd& theta = estimate.theta;
    const ModulusBounds bounds = all_bounds(options, problem.num_unknown());
    check_cancelled(progress);
    estimate.covariance = laplace_covariance(problem, theta);
    check_cancelled(progress);
    const Eigen::MatrixXd information = problem.seen_information(theta);
    estimate.seen_sd_ln = seen_sd_ln(information, problem.priors());
    estimate.sensitivity = scaled_sensitivity(information, problem.priors());
    estimate.profiles.clear();
    estimate.interval_kpa.clear();
    estimate.excluded_ends.clear();
    for (Index k = 0; k < problem.num_unknown(); ++k) {
        check_cancelled(progress);
        estimate.profiles.push_back(profile_of(problem, theta, estimate.covariance, k));
        estimate.interval_kpa.push_back(
            profile_interval(estimate.profiles.back(), std::exp(theta[k])));
        check_cancelled(progress);
        estimate.excluded_ends.push_back(
            excluded_ends(problem, theta, estimate.covariance, k, bounds));
    }
}

MapEstimate map_estimate(const ResponseModel& model, const WallPrior& walls,
                         const SurfaceObservations& observations,
                         const std::vector<ModulusPrior>& priors, const MapOptions& options,
                         const ProgressSink& progress) {
    return Search(model, walls, observations, priors, options, progress).run();
}

MapEstimate map_estimate_from(const MapEstimate& earlier, const ResponseModel& model,
                              const WallPrior& walls, const SurfaceObservations& observations,
                              const std::vector<ModulusPrior>& priors, const MapOptions& options,
                              const ProgressSink& progress) {
    return Search(model, walls, observations, priors, options, progress).run_from(earlier);
}

MapEstimate map_estimate_near(const MapEstimate& earlier, const ResponseModel& model,
                              const WallPrior& walls, const SurfaceObservations& observations,
                              const std::vector<ModulusPrior>& priors, const MapOptions& options,
                              const ProgressSink& progress) {
    return Search(model, walls, observations, priors, options, progress).run_near(earlier);
}

}  // namespace palpate
