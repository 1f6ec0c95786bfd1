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

#include "host/apps/recover/inverse/surface_noise.hpp"
#include "host/apps/recover/inverse/wall_fit.hpp"
#include "host/estimate/anderson.hpp"
#include "host/estimate/quasi_newton.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int remembered_steps = 8;
constexpr int needed_quiet_steps = 3;
constexpr int tolerated_stalls = 8;
constexpr int most_settling_steps = 10;
constexpr int noise_rounds = 4;  // at each linearisation
constexpr double deeper = 0.1;   // of F, by which another valley must be
constexpr double stiff_share = 0.25, body_share = 3.0;
constexpr double first_contour_mm = 1.0, least_contour_mm = 0.05;
constexpr double mm_per_unit_ln = 10.0;  // weight of ln E beside one driven component, in Anderson

/// How much the objective may rise in an accelerated step: far below what a modulus would notice.
constexpr double acceptable_rise = 0.05;

double largest(const Eigen::VectorXd& vector) {
    return vector.size() == 0 ? 0.0 : vector.cwiseAbs().maxCoeff();
}

bool differs(double a, double b) { return std::abs(a - b) >= 0.02 * std::max(a, b) && a != b; }

bool is_other(const NoiseLevel& a, const NoiseLevel& b) {
    return differs(a.scale, b.scale) || differs(a.contour_mm, b.contour_mm);
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

Bounds all_bounds(const MapOptions& options, Index num_unknown) {
    return same_bounds(num_unknown, std::log(options.smallest_kpa), std::log(options.largest_kpa));
}

using Counted = std::shared_ptr<const CountedRows>;

/// What is searched for.
struct Position {
    Eigen::VectorXd driven;
    FrameMotion frame = FrameMotion::Zero();
    Eigen::VectorXd theta;

    /// Part of the way to another.
    Position towards(const Position& other, double t) const {
        return {driven + t * (other.driven - driven), frame + t * (other.frame - frame),
                theta + t * (other.theta - theta)};
    }
    /// As one vector, in which a unit of each has about the same weight.
    Eigen::VectorXd scaled() const {
        Eigen::VectorXd all(driven.size() + 6 + theta.size());
        all << driven, frame, mm_per_unit_ln * theta;
        return all;
    }
};

Position position_of(const BestModuli& best) {
    return {best.fit.driven, best.fit.frame, best.theta};
}

struct State : Position {
    Eigen::VectorXd observed;
    ObservedState seen;
    Counted counted;       ///< the rows that the objective is over
    double objective = 0;  ///< nonlinear, without the determinant
};

class Search {
public:
    Search(const ResponseModel& model, const WallPrior& walls,
           const SurfaceObservations& observations, const std::vector<Unknown>& unknowns,
           const MapOptions& options, const ProgressSink& progress)
        : model_(std::shared_ptr<void>(), &model),
          walls_(std::shared_ptr<void>(), &walls),
          observations_(observations),
          noise_(observations),
          unknowns_(unknowns),
          options_(options),
          progress_(progress),
          bounds_(all_bounds(options, static_cast<Index>(unknowns.size()))) {}

    MapEstimate run();
    MapEstimate run_from(const MapEstimate& earlier);
    MapEstimate run_near(const MapEstimate& earlier);

private:
    /// `is_scanned`: the moduli start at the best of a coarse scan, not at those of `state`.
    MapEstimate iterate(State state, bool is_scanned);
    /// Without `counted` all rows that are seen there count.
    State state_at(const Position& position, const Counted& counted) const;
    double objective_of(const State& state) const;
    /// The same place, its objective over what is seen there with the noise that it has there.
    State recounted(State state) const;
    std::vector<LinearRow> rows_of(const State& state) const;
    LinearisedProblem linearise(const State& state) const;
    State settle_walls(State state, bool is_smooth = false) const;
    State settle_bodies(State state);
    bool can_fit_walls(const State& state) const;
    State search_line(const State& from, const Position& to, double determinant_change,
                      double& length) const;
    FramePrior frame_of(const State& state) const;
    State accelerated_step(const State& from, const BestModuli& best,
                           AndersonAcceleration& acceleration, bool& improved) const;
    State blind_step(const State& from, const BestModuli& best) const;
    NoiseLevel first_level() const;
    NoiseLevel level_for(const LinearisedProblem::Fit& fit) const;
    double scale_for(const LinearisedProblem::Fit& fit) const;
    double contour_mm_for(const LinearisedProblem::Fit& fit) const;
    BestModuli best_moduli(State& state, bool is_scanned);
    bool settle_noise(State& state, BestModuli& best, bool is_scanned);
    bool leaves_valley(State& state);
    State with_fitted_walls(State state);
    void take_walls(const std::shared_ptr<const WallPrior>& walls);
    void record(int iteration, const State& state, const BestModuli& best, double step);
    MapEstimate finish(const State& state, const Termination& termination) const;

    std::shared_ptr<const ResponseModel> model_;
    std::shared_ptr<const WallPrior> walls_;
    bool are_walls_fitted_ = false;
    /// At the moduli of the last state; that walls are fitted does not change it.
    mutable std::optional<std::pair<Eigen::VectorXd, ResponseModel::Equilibrium>> equilibrium_;
    const SurfaceObservations& observations_;
    SurfaceNoise noise_;
    Counted held_;  ///< of an earlier estimate: these rows count, with their noise. Empty: a fresh
                    ///< search.
    const std::vector<Unknown>& unknowns_;
    const MapOptions& options_;
    const ProgressSink& progress_;
    Bounds bounds_;
    Eigen::MatrixXd hessian_;  ///< of F, as far as the last linearisation knew it
    std::vector<IterationRecord> records_;
};

State Search::state_at(const Position& position, const Counted& counted) const {
    std::vector<Index> unknown;
    for (const Unknown& one : unknowns_) unknown.push_back(one.object);
    if (!equilibrium_ || equilibrium_->first != position.theta)
        equilibrium_ = {position.theta,
                        model_->equilibrium_at(model_->moduli(unknown, position.theta))};
    State state{position,
                model_->observed_displacement(equilibrium_->second, position.driven),
                {},
                counted,
                0};
    state.seen = observations_.evaluate(state.driven, state.observed, state.frame);
    if (!counted) return recounted(std::move(state));
    state.objective = objective_of(state);
    return state;
}

double Search::objective_of(const State& state) const {
    return state.counted->misfit(state.seen.residual_mm) + walls_->energy(state.driven) +
           state.counted->energy(state.frame) + prior_energy(unknowns_, state.theta);
}

State Search::recounted(State state) const {
    state.counted = held_ ? held_ : noise_.count(state.seen);
    state.objective = objective_of(state);
    return state;
}

std::vector<LinearRow> Search::rows_of(const State& state) const {
    return state.counted->linear_rows(state.seen);
}

LinearisedProblem Search::linearise(const State& state) const {
    check_cancelled(progress_);
    return LinearisedProblem(*model_, *walls_, rows_of(state), state.driven, state.observed,
                             unknowns_, frame_of(state));
}

FramePrior Search::frame_of(const State& state) const {
    FramePrior frame = state.counted->frame();
    frame.motion = state.frame;
    return frame;
}

/// Brings the driven walls near their targets with the moduli held, before anything is concluded
/// from the observed surfaces.
State Search::settle_walls(State state, bool is_smooth) const {
    for (int k = 0; k < most_settling_steps; ++k) {
        double length = 0;
        const WallPosterior walls(*walls_, state.counted->linear_rows(state.seen, is_smooth),
                                  state.driven, frame_of(state));
        const State next =
            search_line(state, {walls.mean(), walls.frame_mean(), state.theta}, 0.0, length);
        const double moved = largest(next.driven - state.driven);
        state = recounted(next);
        if (length == 0 || moved < 0.1) break;
    }
    return state;
}

/// The same as bodies that hardly change their shape, then with the shape that they are expected to
/// take: where a wall has slid along itself far, closest points would hold it where it is.
State Search::settle_bodies(State state) {
    const auto asked = walls_;
    WallMotionScale scale = expected_scale(*asked);
    for (auto& wall : scale.walls) wall.normal_mm *= stiff_share;
    scale.rigid_mm *= body_share;
    for (int k = 0; k < 2; ++k) {
        walls_ = walls_of(*asked, k == 0 ? scale : expected_scale(*asked));
        state = settle_walls(recounted(std::move(state)), true);
    }
    walls_ = asked;
    return recounted(std::move(state));
}

/// Line search on the nonlinear objective, with the determinant of this linearisation (taken as
/// linear along the step). Gauss-Newton leaves out how the surfaces curve, so in some directions it
/// goes twice too far, step after step: a parabola through three points finds the right length.
State Search::search_line(const State& from, const Position& to, double determinant_change,
                          double& length) const {
    State best = from;
    double lowest = from.objective;
    length = 0;
    const auto offer = [&](double t) {
        check_cancelled(progress_);
        State trial = state_at(from.towards(to, t), from.counted);
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
State Search::accelerated_step(const State& from, const BestModuli& best,
                               AndersonAcceleration& acceleration, bool& improved) const {
    const Index n = model_->driven_dofs();
    const double determinant_change = best.end.log_determinant - best.start.log_determinant;
    const Position to = position_of(best);
    const Eigen::VectorXd point = from.scaled();
    const Eigen::VectorXd proposal = acceleration.next(point, to.scaled() - point);
    improved = true;
    if (acceleration.has_history()) {
        const Eigen::VectorXd theta = (proposal.tail(from.theta.size()) / mm_per_unit_ln)
                                          .cwiseMax(bounds_.lower)
                                          .cwiseMin(bounds_.upper);
        State trial = state_at({proposal.head(n), proposal.segment<6>(n), theta}, from.counted);
        const double allowed = from.objective - 0.5 * determinant_change + acceptable_rise;
        if (std::isfinite(trial.objective) && trial.objective <= allowed) return trial;
        acceleration.reset();
    }
    double length = 0;
    State next = search_line(from, to, determinant_change, length);
    improved = length > 0;
    return next;
}

/// Half the Gauss-Newton step, whatever the objective says: where closest points jump between the
/// facets of a target, the objective has kinks at which no line search goes down.
State Search::blind_step(const State& from, const BestModuli& best) const {
    return state_at(from.towards(position_of(best), 0.5), from.counted);
}

NoiseLevel Search::first_level() const {
    const double contours =
        options_.contour_mm.value_or(options_.estimate_noise ? first_contour_mm : 0.0);
    return {std::max(1.0, options_.smallest_noise_scale), contours};
}

NoiseLevel Search::level_for(const LinearisedProblem::Fit& fit) const {
    NoiseLevel level = noise_.level();
    if (!options_.estimate_noise) return level;
    if (!options_.contour_mm) level.contour_mm = contour_mm_for(fit);
    level.scale = scale_for(fit);
    return level;
}

/// sigma_n^2 such that the observed residual has the size that its own model predicts:
/// E[r^T R^-1 r] = tr(R C^-1) for r = R C^-1 e.
double Search::scale_for(const LinearisedProblem::Fit& fit) const {
    if (fit.effective_rows < 1) return noise_.level().scale;
    const double factor = std::clamp(std::sqrt(fit.weighted_misfit / fit.effective_rows), 0.5, 2.0);
    return std::clamp(noise_.level().scale * factor, options_.smallest_noise_scale, 20.0);
}

/// The contours' error such that E[r^T D r] = tr(D R C^-1 R). Not weighted by R^-1: that asks the
/// shortest waves, where the kernel is least certain and moduli do not show.
double Search::contour_mm_for(const LinearisedProblem::Fit& fit) const {
    if (!(fit.expected_misfit_mm2 > 0)) return noise_.level().contour_mm;
    return std::clamp(noise_.contour_mm_for(fit.misfit_mm2 / fit.expected_misfit_mm2),
                      least_contour_mm, most_contour_mm);
}

/// The most probable moduli with the surfaces linearised at `state`, whose own become those of a
/// scan if that is asked for.
BestModuli Search::best_moduli(State& state, bool is_scanned) {
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
bool Search::settle_noise(State& state, BestModuli& best, bool is_scanned) {
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
bool Search::leaves_valley(State& state) {
    const LinearisedProblem problem = linearise(state);
    const Eigen::VectorXd theta = scan_grid(problem, bounds_);
    const std::vector<double> values = problem.objectives({state.theta, theta});
    if (!(values[1] < values[0] - deeper)) return false;
    hessian_ = {};
    state = recounted(state_at({state.driven, state.frame, theta}, state.counted));
    return true;
}

/// Where no modulus is asked for, walls move as the settings say: the fit is for what moduli see.
bool Search::can_fit_walls(const State& state) const {
    const std::vector<LinearRow> rows = rows_of(state);
    const bool any = std::any_of(rows.begin(), rows.end(), [](auto& row) { return row.on_driven; });
    return options_.fit_walls && any && !unknowns_.empty() &&
           !walls_->expectation().normals.empty();
}

/// What is expected of the walls' motion becomes what their own distances show of it.
State Search::with_fitted_walls(State state) {
    if (!can_fit_walls(state)) return state;
    const WallMotionScale scale = fit_walls(*walls_, rows_of(state), state.driven, frame_of(state));
    take_walls(walls_of(*walls_, scale));
    return recounted(std::move(state));
}

void Search::take_walls(const std::shared_ptr<const WallPrior>& walls) {
    if (!walls) return;
    walls_ = walls;
    model_ = std::make_shared<ResponseModel>(model_->with_walls(*walls));
    are_walls_fitted_ = true;
}

void Search::record(int iteration, const State& state, const BestModuli& best, double step) {
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
    report_progress(progress_, "searching", -1,
                    fmt::format("iteration {}:{} step {:.2g} mm, objective {:.2f}, contours {:.2f} "
                                "mm off, sigma_n x {:.2f}",
                                iteration, text, step, entry.objective, noise_.level().contour_mm,
                                noise_.level().scale));
}

MapEstimate Search::run() {
    Eigen::VectorXd theta(unknowns_.size());
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
        theta[k] = options_.start_kpa > 0 ? std::log(options_.start_kpa) : unknowns_[k].mean;
    }
    noise_.set_level(first_level());
    State state = state_at(
        {Eigen::VectorXd::Zero(model_->driven_dofs()), FrameMotion::Zero(), theta}, nullptr);
    const bool are_walls_open = can_fit_walls(state);
    state = are_walls_open ? settle_bodies(state) : settle_walls(state);
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

MapEstimate Search::iterate(State state, bool is_scanned) {
    Termination termination{
        false, fmt::format("{} iterations were not enough", options_.max_iterations), 0};
    AndersonAcceleration acceleration(remembered_steps);
    int quiet_steps = 0, stalls = 0;
    bool is_checked = !is_scanned || unknowns_.empty();  // for deeper valleys
    for (int k = 1; k <= options_.max_iterations; ++k) {
        const bool is_noise_open = k < options_.noise_iterations && !held_;
        BestModuli best = best_moduli(state, k == 1 && is_scanned);
        const bool is_noise_new = is_noise_open && settle_noise(state, best, k == 1 && is_scanned);
        if (is_noise_new) acceleration.reset();
        const double moved = largest(best.fit.driven - state.driven);
        const Eigen::VectorXd theta_before = state.theta;
        bool improved = true;
        state = recounted(accelerated_step(state, best, acceleration, improved));
        record(k, state, best, moved);
        termination.iterations = k;
        if (is_noise_open) {
            noise_.take_terraces(state.seen);
            state = recounted(state);
        }
        if (k + 1 == options_.noise_iterations && is_noise_open && is_scanned) {
            state = with_fitted_walls(state);
            acceleration.reset();
            continue;
        }
        if (is_noise_new) continue;
        const double changed = largest(in_standard_deviations(state.theta - theta_before, best));
        const double objective_changed =
            k == 1 ? 1e300 : std::abs(records_[k - 1].objective - records_[k - 2].objective);
        const bool is_quiet =
            changed < options_.modulus_tolerance_sd &&
            objective_changed < options_.objective_tolerance_per_row * observations_.num_rows();
        quiet_steps = is_quiet ? quiet_steps + 1 : 0;
        if (quiet_steps == needed_quiet_steps) {
            if (!std::exchange(is_checked, true) && leaves_valley(state)) {
                acceleration.reset();
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
    const Bounds bounds = all_bounds(options, problem.num_unknown());
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
