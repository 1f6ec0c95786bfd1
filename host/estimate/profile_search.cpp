// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/profile_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/estimate/posterior.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double z_tolerance = 0.06;
/// Of F, that a search along a profile may leave: it is known and taken off.
constexpr double left_gain = 0.5;
constexpr int max_profile_points = 6, most_profile_steps = 6, most_guided_steps = 15;
constexpr double nearly =
    0.95;  ///< of the rise that excludes: the 95 % interval's, but for a little
/// A profile is followed at most so far: sd of the prior, or of the Laplace posterior if flat.
constexpr double max_prior_reach = 4.0, max_laplace_reach = 30.0;
constexpr double max_ridge = 20.0;  ///< of a logarithm or a logit

GaussNewtonOptions loosened(GaussNewtonOptions options) {
    options.gain_tolerance = std::max(options.gain_tolerance, left_gain);
    options.max_steps = std::min(options.max_steps, most_profile_steps);
    return options;
}

}  // namespace

ProfileSearch::ProfileSearch(const DataProblem& problem, const Fit& fit,
                             const Eigen::MatrixXd& covariance, const GaussNewtonOptions& options,
                             ProfileGuide make_guide, const ProgressSink& progress)
    : problem_(problem),
      parameters_(problem.parameters()),
      fit_(fit),
      covariance_(covariance),
      options_(loosened(options)),
      make_guide_(std::move(make_guide)),
      shared_(progress),
      progress_(shared_.sink()),
      range_(range_of(parameters_)),
      priors_(priors_of(parameters_)),
      lowest_(minus_log_posterior(parameters_, *fit.prediction, *fit.noise)) {}

Eigen::VectorXd ProfileSearch::within(Eigen::VectorXd transformed) const {
    return transformed.cwiseMax(range_.lower).cwiseMin(range_.upper);
}

/// Parameter k at t, the others at their conditional means in the Laplace posterior. Of a number
/// that is hardly known these lie where the number itself is 0 or infinite: not so far.
Eigen::VectorXd ProfileSearch::on_ridge(Index k, double t) const {
    Eigen::VectorXd step = (t - fit_.transformed[k]) / covariance_(k, k) * covariance_.col(k);
    for (Index i = 0; i < step.size(); ++i)
        if (i != k && parameters_[std::size_t(i)].transform != Transform::identity)
            step[i] = std::clamp(step[i], -max_ridge, max_ridge);
    return within(fit_.transformed + step);
}

/// F there less F at the fit; infinite without a prediction.
double ProfileSearch::rise_at(const Eigen::VectorXd& transformed) {
    check_cancelled(progress_);
    ++num_prediction_;
    const auto predicted = [&](const Prediction* warm) {
        return checked_prediction(problem_, to_values(parameters_, transformed),
                                  PredictedColumns::none, warm);
    };
    PredictionAttempt made = predicted(fit_.prediction.get());
    if (!made.prediction) {
        // From a far state it may have been given up too early, and an end must not count as
        // excluded for that.
        ++num_prediction_;
        made = predicted(nullptr);
    }
    if (!made.prediction) return infinite;
    NoiseModel noise = *fit_.noise;
    noise.reweight(*made.prediction);
    return minus_log_posterior(parameters_, *made.prediction, noise) - lowest_;
}

/// Where the guide has its minimum with parameter k held; null if it finds none. Steps with columns
/// are what costs, and from a straight line's end far from the fit it takes many.
std::shared_ptr<const Prediction> ProfileSearch::guided(Index k, const Eigen::VectorXd& start,
                                                        const Point& nearest) {
    if (!guide_) return nullptr;
    GaussNewtonOptions options = options_;
    options.max_steps = most_guided_steps;
    try {
        NoiseModel noise = *fit_.noise;
        const GaussNewtonMinimum found = minimise_gauss_newton(
            *guide_, noise, {to_values(parameters_, start), nearest.guided, {k}}, options,
            progress_);
        return found.ending == Ending::converged ? found.prediction : nullptr;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        return nullptr;
    }
}

/// From there to the minimum with parameter k held, into `point` if that is lower than what is
/// there. Whether the search has converged.
bool ProfileSearch::minimise(Index k, const Eigen::VectorXd& values, const Point& nearest,
                             Point& point) {
    try {
        NoiseModel noise = *fit_.noise;
        const GaussNewtonMinimum found = minimise_gauss_newton(
            problem_, noise, {values, nearest.prediction, {k}}, options_, progress_);
        num_prediction_ += found.num_prediction;
        // Less what the last step would still have gained; at a kink that is a promise alone.
        const double left =
            found.ending == Ending::converged || found.ending == Ending::too_many_steps
                ? found.predicted_gain
                : std::min(found.predicted_gain, left_gain);
        const double z = std::sqrt(2.0 * std::max(0.0, found.objective - left - lowest_));
        const bool has_converged = found.ending == Ending::converged;
        if (z >= point.z) return has_converged;
        point.z = z;
        const double t = point.transformed[k];
        point.transformed = found.transformed;
        point.transformed[k] = t;
        point.prediction = found.prediction;
        return has_converged;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        ++num_prediction_;
        return false;
    }
}

ProfileSearch::Point ProfileSearch::profile_at(Index k, double t, const Point& nearest) {
    Point point{infinite,
                nearest.transformed + on_ridge(k, t) - on_ridge(k, nearest.transformed[k]),
                nearest.prediction, nearest.guided};
    point.transformed[k] = t;
    const Eigen::VectorXd straight = within(point.transformed);
    if (const auto at_guided = guided(k, straight, nearest)) {
        point.guided = at_guided;
        if (minimise(k, at_guided->values, nearest, point)) return point;
    }
    minimise(k, to_values(parameters_, straight), nearest, point);
    return point;
}

double ProfileSearch::farthest(Index k, double direction) const {
    const double end = direction < 0 ? range_.lower[k] : range_.upper[k];
    const double sd = std::sqrt(covariance_(k, k));
    const double reach =
        std::max(max_laplace_reach * sd * (parameters_[k].has_prior() ? 0 : 1),
                 parameters_[k].has_prior() ? max_prior_reach * parameters_[k].sd : 0.0);
    const double looked = fit_.transformed[k] + direction * std::max(reach, 4.0 * sd);
    return direction < 0 ? std::max(end, looked) : std::min(end, looked);
}

/// Secant on the root of the rise, which is linear for a Gaussian, within a bracket that begins
/// with `first`. Where the points do not suffice it is the outer side of the bracket, so that the
/// interval is too wide rather than too narrow.
double ProfileSearch::profile_end(Index k, double reach, double direction, Point first,
                                  bool& is_cut) {
    Point inside{0, fit_.transformed, fit_.prediction};
    const double last = farthest(k, direction);
    double outside = last, outside_z = infinite;
    bool is_bracketed = false;
    Point found = std::move(first);
    for (int point = 0;; ++point) {
        double t = found.transformed[k];
        if (std::abs(found.z - reach) < z_tolerance) return t;
        if (found.z < reach) {
            if (t == last) break;
            inside = std::move(found);
        } else {
            outside = t;
            outside_z = found.z;
            is_bracketed = true;
        }
        if (point == max_profile_points) break;
        const double begin = inside.transformed[k];
        if (is_bracketed && !std::isfinite(outside_z))
            t = 0.5 * (begin + outside);
        else if (is_bracketed)
            t = begin + (outside - begin) *
                            std::clamp((reach - inside.z) / (outside_z - inside.z), 0.1, 0.9);
        else
            t = fit_.transformed[k] +
                (begin - fit_.transformed[k]) * std::clamp(reach / inside.z, 1.2, 3.0);
        t = direction < 0 ? std::max(t, outside) : std::min(t, outside);
        found = profile_at(k, t, inside);
    }
    is_cut = !is_bracketed || !std::isfinite(outside_z);
    return is_bracketed && is_cut ? 0.5 * (inside.transformed[k] + outside) : outside;
}

/// The profile at the end of the quadratic interval, or at the last place that is looked at.
ProfileSearch::Point ProfileSearch::quadratic_end(const WantedInterval& wanted, int side) {
    const Index k = wanted.parameter;
    const double direction = side == 0 ? -1.0 : 1.0, last = farthest(k, direction);
    const double t = fit_.transformed[k] + direction * wanted.reach * std::sqrt(covariance_(k, k));
    return profile_at(k, direction < 0 ? std::max(t, last) : std::min(t, last),
                      {0, fit_.transformed, fit_.prediction});
}

std::vector<TransformedInterval> ProfileSearch::intervals(const std::vector<WantedInterval>& wanted,
                                                          double tolerance, int jobs) {
    constexpr std::size_t sides = 2;
    if (make_guide_ && !guide_ && !wanted.empty()) guide_ = make_guide_();
    std::vector<std::array<Point, sides>> ends(wanted.size());
    run_tasks(sides * wanted.size(), jobs, shared_, [&](std::size_t task) {
        const std::size_t n = task / sides;
        report_progress(progress_, "intervals", double(task) / double(2 * sides * wanted.size()),
                        label_of(parameters_[std::size_t(wanted[n].parameter)]));
        ends[n][task % sides] = quadratic_end(wanted[n], int(task % sides));
    });
    std::vector<TransformedInterval> intervals(wanted.size());
    for (std::size_t n = 0; n < wanted.size(); ++n) {
        const auto [k, reach] = wanted[n];
        const double quadratic_rise = 0.5 * reach * reach;
        TransformedInterval& interval = intervals[n];
        for (const std::size_t side : {0, 1}) {
            const double rise = 0.5 * ends[n][side].z * ends[n][side].z;
            interval.rise[side] = rise;
            interval.ends[side] = fit_.transformed[k] +
                                  (side == 0 ? -1.0 : 1.0) * reach * std::sqrt(covariance_(k, k));
            if (ends[n][side].transformed[k] != interval.ends[side] ||
                !(std::abs(rise - quadratic_rise) <= tolerance * quadratic_rise))
                interval.is_profiled = true;
        }
        if (interval.is_profiled) interval.rise = {quadratic_rise, quadratic_rise};
    }
    run_tasks(sides * wanted.size(), jobs, shared_, [&](std::size_t task) {
        const std::size_t n = task / sides, side = task % sides;
        TransformedInterval& interval = intervals[n];
        if (!interval.is_profiled) return;
        const auto [k, reach] = wanted[n];
        report_progress(progress_, "intervals",
                        0.5 + double(task) / double(2 * sides * wanted.size()),
                        label_of(parameters_[std::size_t(k)]));
        interval.ends[side] = profile_end(k, reach, side == 0 ? -1.0 : 1.0,
                                          std::move(ends[n][side]), interval.is_cut[side]);
    });
    return intervals;
}

/// What the prior of k adds to the rise of F at t.
double ProfileSearch::prior_rise(Index k, double t) const {
    const auto energy = [&](double at) {
        return 0.5 * priors_.precision[k] * (at - priors_.mean[k]) * (at - priors_.mean[k]);
    };
    return energy(t) - energy(fit_.transformed[k]);
}

/// How much less likely the data alone are there: F without the prior of k.
double ProfileSearch::data_rise(Index k, const Eigen::VectorXd& transformed) {
    return rise_at(transformed) - prior_rise(k, transformed[k]);
}

/// Whether the data alone have already excluded what is beyond the end of the interval, if F does
/// not fall again farther out: then no prediction there is needed.
bool ProfileSearch::is_excluded_within(Index k, const TransformedInterval& interval,
                                       int side) const {
    if (interval.is_cut[side]) return false;
    return interval.rise[side] - prior_rise(k, interval.ends[side]) > nearly * profile_rise;
}

std::array<bool, 2> ProfileSearch::excluded_ends(Index k, const TransformedInterval& interval) {
    const double reach =
        parameters_[k].has_prior() ? max_prior_reach * parameters_[k].sd : infinite;
    std::array<bool, 2> excluded{true, true};
    for (const int side : {0, 1}) {
        const double end = side == 0 ? std::max(range_.lower[k], priors_.mean[k] - reach)
                                     : std::min(range_.upper[k], priors_.mean[k] + reach);
        if (!std::isfinite(end) || is_excluded_within(k, interval, side)) continue;
        Eigen::VectorXd alone = fit_.transformed;
        alone[k] = end;
        excluded[side] =
            std::min(data_rise(k, alone), data_rise(k, on_ridge(k, end))) > profile_rise;
    }
    return excluded;
}

}  // namespace palpate
