// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/map_estimate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/inverse/modulus_search.hpp"
#include "host/inverse/uncertainty.hpp"

namespace palpate {
namespace {

constexpr int noise_iterations = 8;  // sigma_n is held from here on, so that the steps can settle

struct State {
    Eigen::VectorXd driven, observed, theta;
    ObservedState seen;
    double objective = 0;  ///< nonlinear, without the determinant
};

class Search {
public:
    Search(const ReducedModel& model, const SurfaceObservations& observations,
           const Eigen::SparseMatrix<double>& precision, const std::vector<ModulusPrior>& priors,
           const MapOptions& options, const ProgressSink& progress)
        : model_(model),
          observations_(observations),
          precision_(precision),
          priors_(priors),
          options_(options),
          progress_(progress),
          bounds_{std::log(options.smallest_kpa), std::log(options.largest_kpa)} {}

    MapEstimate run();

private:
    State state_at(const Eigen::VectorXd& driven, const Eigen::VectorXd& theta) const;
    LinearisedProblem linearise(const State& state) const;
    State settle_walls(State state) const;
    State step_towards(const State& from, const LinearisedProblem& problem,
                       const Eigen::VectorXd& driven, const Eigen::VectorXd& theta,
                       double& length) const;
    void update_noise(const LinearisedProblem& problem, const State& state);
    void record(int iteration, const State& state, const LinearisedProblem& problem,
                double gradient, double step);
    MapEstimate finish(const State& state, const Termination& termination) const;

    ReducedModel model_;
    const SurfaceObservations& observations_;
    const Eigen::SparseMatrix<double>& precision_;
    const std::vector<ModulusPrior>& priors_;
    const MapOptions& options_;
    const ProgressSink& progress_;
    ModulusBounds bounds_;
    double noise_scale_ = 1.0;
    std::vector<IterationRecord> records_;
};

State Search::state_at(const Eigen::VectorXd& driven, const Eigen::VectorXd& theta) const {
    ReducedModel model = model_;
    for (std::size_t k = 0; k < priors_.size(); ++k) {
        model.set_stiffness(priors_[k].region, std::exp(theta[k]));
    }
    State state{driven, model.observed_displacement(driven), theta, {}, 0};
    state.seen = observations_.evaluate(state.driven, state.observed);
    for (Index k = 0; k < observations_.num_rows(); ++k) {
        const double z =
            state.seen.residual_mm[k] / (noise_scale_ * observations_.rows()[k].sigma_mm);
        state.objective += 0.5 * z * z;
    }
    state.objective += 0.5 * driven.dot(precision_ * driven);
    for (std::size_t k = 0; k < priors_.size(); ++k) {
        const double z = (theta[k] - priors_[k].mean_ln) / priors_[k].sd_ln;
        state.objective += 0.5 * z * z;
    }
    return state;
}

LinearisedProblem Search::linearise(const State& state) const {
    std::vector<LinearRow> rows(observations_.num_rows());
    for (Index k = 0; k < observations_.num_rows(); ++k) {
        const auto& row = observations_.rows()[k];
        rows[k] = {row.on_driven, row.position, state.seen.normal.row(k),
                   state.seen.residual_mm[k], noise_scale_ * row.sigma_mm};
    }
    return LinearisedProblem(model_, rows, state.driven, state.observed, precision_, priors_);
}

/// Brings the driven walls near their targets with the moduli held, before anything is concluded
/// from the observed surfaces.
State Search::settle_walls(State state) const {
    for (int k = 0; k < 6; ++k) {
        const LinearisedProblem problem = linearise(state);
        double length = 0;
        const State next =
            step_towards(state, problem, problem.driven_mean(), state.theta, length);
        const double moved = (next.driven - state.driven).cwiseAbs().maxCoeff();
        state = next;
        if (length == 0 || moved < 0.1) break;
    }
    return state;
}

/// Backtracking on the nonlinear objective with the determinant of this linearisation.
State Search::step_towards(const State& from, const LinearisedProblem& problem,
                           const Eigen::VectorXd& driven, const Eigen::VectorXd& theta,
                           double& length) const {
    const auto total = [&](const State& state) {
        return state.objective + 0.5 * problem.evaluate(state.theta, false).log_determinant;
    };
    const double start = total(from);
    for (length = 1.0; length > 1e-3; length *= 0.5) {
        const State trial = state_at(from.driven + length * (driven - from.driven),
                                     from.theta + length * (theta - from.theta));
        if (std::isfinite(trial.objective) && total(trial) <= start + 1e-9 * std::abs(start)) {
            return trial;
        }
    }
    length = 0;
    return from;
}

/// sigma_n^2 such that the observed residual has the size that its own model predicts:
/// E[r^T R^-1 r] = trace(R C^-1) for r = R C^-1 e.
void Search::update_noise(const LinearisedProblem& problem, const State& state) {
    const auto at = problem.evaluate(state.theta, false);
    double misfit = 0;
    Index rows = 0;
    for (Index k = 0; k < observations_.num_rows(); ++k) {
        const auto& row = observations_.rows()[k];
        if (row.on_driven) continue;
        const double z = state.seen.residual_mm[k] / (noise_scale_ * row.sigma_mm);
        misfit += z * z;
        ++rows;
    }
    if (rows == 0 || at.effective_rows < 1) return;
    const double factor = std::sqrt(misfit / at.effective_rows);
    noise_scale_ = std::clamp(noise_scale_ * std::clamp(factor, 0.5, 2.0), 0.3, 20.0);
}

void Search::record(int iteration, const State& state, const LinearisedProblem& problem,
                    double gradient, double step) {
    IterationRecord entry;
    entry.iteration = iteration;
    entry.objective =
        state.objective + 0.5 * problem.evaluate(state.theta, false).log_determinant;
    entry.gradient_norm = gradient;
    entry.step = step;
    std::string text;
    for (Index k = 0; k < state.theta.size(); ++k) {
        entry.stiffness_kpa.push_back(std::exp(state.theta[k]));
        text += fmt::format(" {:.4g} kPa", entry.stiffness_kpa.back());
    }
    records_.push_back(entry);
    report_progress(progress_, "searching", -1,
                    fmt::format("iteration {}: objective {:.2f}, step {:.2g},{} noise x {:.2f}",
                                iteration, entry.objective, step, text, noise_scale_));
}

MapEstimate Search::run() {
    Eigen::VectorXd theta(priors_.size());
    for (std::size_t k = 0; k < priors_.size(); ++k) theta[k] = priors_[k].mean_ln;
    State state = settle_walls(state_at(Eigen::VectorXd::Zero(model_.driven_dofs()), theta));

    Termination termination{false, fmt::format("{} iterations were not enough",
                                               options_.max_iterations), 0};
    for (int k = 1; k <= options_.max_iterations; ++k) {
        const LinearisedProblem problem = linearise(state);
        const Eigen::VectorXd start =
            k == 1 ? scan_moduli(problem, bounds_) : Eigen::VectorXd(state.theta);
        const ModulusMinimum best = minimise_moduli(problem, start, bounds_);
        double length = 0;
        const State next = step_towards(state, problem,
                                        problem.evaluate(best.theta, false).driven, best.theta,
                                        length);
        const double moved = next.driven.size() == 0
                                 ? 0.0
                                 : (next.driven - state.driven).cwiseAbs().maxCoeff();
        const double changed = next.theta.size() == 0
                                   ? 0.0
                                   : (next.theta - state.theta).cwiseAbs().maxCoeff();
        state = next;
        record(k, state, problem, best.gradient_norm, moved);
        termination.iterations = k;
        const bool noise_settled =
            !options_.estimate_noise || priors_.empty() || k >= noise_iterations;
        if (length == 0) {
            termination.reason = "the line search found no lower point";
            termination.converged = false;
            break;
        }
        if (noise_settled && moved < options_.displacement_tolerance_mm &&
            changed < options_.modulus_tolerance) {
            termination.converged = true;
            termination.reason = fmt::format(
                "last step moved no driven node by more than {:.2g} mm and ln E by {:.2g}", moved,
                changed);
            break;
        }
        if (!noise_settled) {
            update_noise(linearise(state), state);
            state = state_at(state.driven, state.theta);
        }
    }
    return finish(state, termination);
}

MapEstimate Search::finish(const State& state, const Termination& termination) const {
    MapEstimate estimate;
    estimate.driven = state.driven;
    estimate.observed = state.observed;
    estimate.unknown = priors_;
    estimate.theta = state.theta;
    estimate.noise_scale = noise_scale_;
    estimate.records = records_;
    estimate.termination = termination;
    const LinearisedProblem problem = linearise(state);
    estimate.covariance = laplace_covariance(problem, state.theta);
    for (Index k = 0; k < problem.num_unknown(); ++k) {
        estimate.profiles.push_back(profile_of(problem, state.theta, estimate.covariance, k));
        estimate.interval_kpa.push_back(
            profile_interval(estimate.profiles.back(), std::exp(state.theta[k])));
    }
    return estimate;
}

}  // namespace

MapEstimate map_estimate(const ReducedModel& model, const SurfaceObservations& observations,
                         const Eigen::SparseMatrix<double>& precision,
                         const std::vector<ModulusPrior>& priors, const MapOptions& options,
                         const ProgressSink& progress) {
    return Search(model, observations, precision, priors, options, progress).run();
}

}  // namespace palpate
