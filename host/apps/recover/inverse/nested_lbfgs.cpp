// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/nested_lbfgs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "host/estimate/lbfgs.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

/// What an inner search leaves behind.
struct ForceMinimum {
    Eigen::VectorXd force;  ///< [3 num_driven] mN
    NestedState state;
    LbfgsResult search;
};

class NestedSearch {
public:
    NestedSearch(const RecoveryModel& recovery, const SurfaceObservations& observations,
                 const NestedOptions& options, const ProgressSink& progress)
        : objective_(recovery, observations, options.direct_library),
          options_(options),
          progress_(progress) {}

    NestedEstimate run();

private:
    Index num_unknown() const { return static_cast<Index>(objective_.unknown().size()); }
    double remaining_s() const;
    bool is_out_of_time() const { return options_.time_limit_s > 0 && remaining_s() <= 0; }
    LbfgsOptions inner_options(double tolerance, int max_evaluations) const;
    ForceMinimum minimise_forces(const Eigen::VectorXd& theta, const LbfgsOptions& options);
    Eigen::VectorXd scan();
    double evaluate_moduli(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient);
    Termination minimise_moduli(const Eigen::VectorXd& start);
    void record(const Eigen::VectorXd& theta, const ForceMinimum& found, double gradient_norm);
    std::string moduli_text(const Eigen::VectorXd& theta) const;

    NestedObjective objective_;
    const NestedOptions& options_;
    const ProgressSink& progress_;
    Clock::time_point start_ = Clock::now();
    long inner_iterations_ = 0;
    ForceMinimum best_;  ///< lowest Phi of the outer search
    Eigen::VectorXd best_theta_;
    Eigen::VectorXd last_displacement_;
    std::vector<IterationRecord> records_;
};

/// Thrown through the outer search when time is up; caught where that search was started.
struct OutOfTime {};

double NestedSearch::remaining_s() const {
    return options_.time_limit_s - std::chrono::duration<double>(Clock::now() - start_).count();
}

LbfgsOptions NestedSearch::inner_options(double tolerance, int max_evaluations) const {
    LbfgsOptions options;
    options.relative_tolerance = tolerance;
    options.max_evaluations = max_evaluations;
    if (options_.time_limit_s > 0) options.time_limit_s = std::max(1e-3, remaining_s());
    return options;
}

/// min over f of Phi(E, f), from the best forces of the outer search or, before there are any, from
/// the Dirichlet solve. The forces are searched in units in which minus the first gradient is the
/// best step along it.
ForceMinimum NestedSearch::minimise_forces(const Eigen::VectorXd& theta,
                                           const LbfgsOptions& options) {
    objective_.set_moduli(theta);
    ForceMinimum best;
    best.force = best_.force.size() > 0 ? best_.force : objective_.starting_force();
    best.state = objective_.evaluate(best.force);
    ++inner_iterations_;
    const Eigen::VectorXd& slope = best.state.force_gradient;
    const double curvature = objective_.curvature(best.state, slope);
    const double unit_mn = curvature > 0 ? std::sqrt(slope.squaredNorm() / curvature) : 1.0;
    const auto phi = [&](const Eigen::VectorXd& scaled, Eigen::VectorXd& gradient) {
        const Eigen::VectorXd force = unit_mn * scaled;
        NestedState state = objective_.evaluate(force);
        ++inner_iterations_;
        gradient = unit_mn * state.force_gradient;
        const double value = state.value_mm2;
        if (value < best.state.value_mm2) {
            best.state = std::move(state);
            best.force = force;
        }
        return value;
    };
    const Eigen::VectorXd start = best.force / unit_mn;
    best.search = minimise_lbfgs(phi, start, options);
    return best;
}

/// All unknown moduli together, then each in turn.
Eigen::VectorXd NestedSearch::scan() {
    Eigen::VectorXd best;
    double lowest = std::numeric_limits<double>::infinity();
    const auto offer = [&](const Eigen::VectorXd& theta) {
        if (is_out_of_time() && best.size() > 0) return;
        const double value = minimise_forces(theta, inner_options(options_.scan_tolerance,
                                                                  options_.max_scan_iterations))
                                 .state.value_mm2;
        report_progress(progress_, "searching", -1,
                        fmt::format("scan:{} Phi {:.4g} mm^2", moduli_text(theta), value));
        if (value >= lowest) return;
        lowest = value;
        best = theta;
    };
    for (const double kpa : options_.scan_kpa) {
        offer(Eigen::VectorXd::Constant(num_unknown(), std::log(kpa)));
    }
    for (Index k = 0; num_unknown() > 1 && k < num_unknown(); ++k) {
        for (const double kpa : options_.scan_kpa) {
            Eigen::VectorXd theta = best;
            theta[k] = std::log(kpa);
            if (theta != best) offer(theta);
        }
    }
    return best;
}

/// min over f of Phi(E, f), and its derivative with respect to ln E.
double NestedSearch::evaluate_moduli(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient) {
    if (is_out_of_time() && !records_.empty()) throw OutOfTime{};
    ForceMinimum found = minimise_forces(
        theta, inner_options(options_.relative_tolerance, options_.max_inner_iterations));
    gradient = objective_.modulus_gradient(found.state);
    record(theta, found, gradient.norm());
    const double value = found.state.value_mm2;
    if (best_theta_.size() == 0 || value < best_.state.value_mm2) {
        best_theta_ = theta;
        best_ = std::move(found);
    }
    return value;
}

/// The outer search, on Phi relative to its first value.
Termination NestedSearch::minimise_moduli(const Eigen::VectorXd& start) {
    LbfgsOptions options;
    options.relative_tolerance = options_.relative_tolerance;
    options.max_evaluations = options_.max_outer_iterations;
    options.lower = Eigen::VectorXd::Constant(num_unknown(), std::log(options_.smallest_kpa));
    options.upper = Eigen::VectorXd::Constant(num_unknown(), std::log(options_.largest_kpa));
    double unit = 0;
    const auto relative = [&](const Eigen::VectorXd& theta, Eigen::VectorXd& gradient) {
        const double value = evaluate_moduli(theta, gradient);
        if (unit == 0) unit = std::max(value, std::numeric_limits<double>::min());
        gradient /= unit;
        return value / unit;
    };
    try {
        const LbfgsResult result = minimise_lbfgs(relative, start, options);
        return {result.converged,
                fmt::format("{}; the last inner search ended because {}", result.reason,
                            best_.search.reason),
                static_cast<int>(records_.size())};
    } catch (const OutOfTime&) {
        return {false, fmt::format("the time limit of {:.4g} s was reached", options_.time_limit_s),
                static_cast<int>(records_.size())};
    }
}

void NestedSearch::record(const Eigen::VectorXd& theta, const ForceMinimum& found,
                          double gradient_norm) {
    IterationRecord entry;
    entry.iteration = static_cast<int>(records_.size()) + 1;
    entry.objective = found.state.value_mm2;
    entry.gradient_norm = gradient_norm;
    if (last_displacement_.size() == 0) {
        last_displacement_ = Eigen::VectorXd::Zero(found.state.displacement.size());
    }
    entry.step = (found.state.displacement - last_displacement_).cwiseAbs().maxCoeff();
    last_displacement_ = found.state.displacement;
    for (Index k = 0; k < theta.size(); ++k) entry.stiffness_kpa.push_back(std::exp(theta[k]));
    records_.push_back(entry);
    report_progress(
        progress_, "searching", -1,
        fmt::format("iteration {}:{} Phi {:.5g} mm^2, slope {:.2g}, {} inner, {} solves in all",
                    entry.iteration, moduli_text(theta), entry.objective, gradient_norm,
                    found.search.evaluations, objective_.num_solves()));
}

std::string NestedSearch::moduli_text(const Eigen::VectorXd& theta) const {
    std::string text;
    for (Index k = 0; k < theta.size(); ++k)
        text += fmt::format(" {:.4g} kPa,", std::exp(theta[k]));
    return text;
}

NestedEstimate NestedSearch::run() {
    NestedEstimate estimate;
    estimate.unknown = objective_.unknown();
    if (num_unknown() == 0) {
        best_ = minimise_forces(
            {}, inner_options(options_.relative_tolerance, options_.max_inner_iterations));
        record({}, best_, 0);
        estimate.termination = {best_.search.converged, best_.search.reason, 1};
    } else {
        estimate.termination =
            minimise_moduli(options_.start.size() == 0 ? scan() : options_.start);
    }
    estimate.displacement = best_.state.displacement;
    estimate.driven_force = best_.force;
    estimate.theta = best_theta_;
    estimate.records = records_;
    estimate.solves = objective_.num_solves();
    estimate.inner_iterations = inner_iterations_;
    return estimate;
}

void check_options(const NestedOptions& options) {
    const bool has_start = options.start.size() > 0 || !options.scan_kpa.empty();
    if (options.relative_tolerance > 0 && options.max_inner_iterations > 0 &&
        options.max_outer_iterations > 0 && options.smallest_kpa > 0 &&
        options.largest_kpa > options.smallest_kpa && has_start) {
        return;
    }
    throw Error(ErrorCode::invalid_argument,
                "nested-lbfgs needs a positive tolerance, positive numbers of iterations, "
                "0 < smallest_kpa < largest_kpa, and a start or values to scan");
}

}  // namespace

NestedEstimate nested_lbfgs(const RecoveryModel& recovery, const SurfaceObservations& observations,
                            const NestedOptions& options, const ProgressSink& progress) {
    check_options(options);
    return NestedSearch(recovery, observations, options, progress).run();
}

}  // namespace palpate
