// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/gauss_newton.hpp"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/estimate/kept_columns.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Directions whose curvature is smaller than this share of the largest, after scaling, are flat.
constexpr double flat_curvature = 1e-14;
/// Changes of F below this share of it are round-off.
constexpr double resolution = 1e-12;
constexpr double max_damping = 1e14;
/// Steps shorter than this share of what is allowed are none.
constexpr double min_reach = 1e-9;
/// Trials after which a search that has gained next to nothing is at its end: F may have kinks,
/// where frames and the times that are solved coincide, and there the quadratic promises what no
/// step gains.
constexpr std::size_t most_idle_trials = 6;
/// Of F, by the least that was promised at such an end: less than half a posterior sd.
constexpr double most_promised = 0.1;

/// Whether the prediction to begin with is of the very start, and has columns.
bool is_complete(const GaussNewtonStart& start) {
    if (!start.warm || start.warm->values != start.values) return false;
    return std::all_of(
        start.warm->blocks.begin(), start.warm->blocks.end(),
        [&](const DataBlock& block) { return block.columns.cols() == start.values.size(); });
}

/// One search; `minimise_gauss_newton` is its loop.
class GaussNewtonSearch {
public:
    GaussNewtonSearch(const DataProblem& problem, NoiseModel& noise, const GaussNewtonStart& start,
                      const GaussNewtonOptions& options, const ProgressSink& progress)
        : problem_(problem),
          parameters_(problem.parameters()),
          noise_(noise),
          options_(options),
          progress_(progress),
          range_(range_of(parameters_)),
          priors_(priors_of(parameters_)),
          is_held_(parameters_.size(), false),
          damping_(options.first_damping) {
        for (const Index k : start.held) is_held_.at(k) = true;
        for (const Index k : held_of(parameters_)) is_held_[k] = true;
        begin(start);
    }

    GaussNewtonMinimum run();

private:
    void begin(const GaussNewtonStart& start);
    void linearise();
    std::vector<Index> free_parameters() const;
    void measure_gain(const std::vector<Index>& free);
    Eigen::VectorXd damped_step(const std::vector<Index>& free) const;
    double enough_gain() const;
    double held_objective(const Prediction& prediction) const;
    std::shared_ptr<const Prediction> predict(const Eigen::VectorXd& values, std::string& failure,
                                              bool keeps_columns = false);
    bool keeps_columns_at(const Eigen::VectorXd& transformed) const;
    bool try_step(const std::vector<Index>& free);
    void accept(std::shared_ptr<const Prediction> prediction, double ratio);
    void reject(bool has_failed);
    bool renew_columns();
    bool is_idle() const;
    double least_promised() const;
    bool is_exhausted() const { return damping_ > max_damping || reach_ < min_reach; }
    void report() const;

    const DataProblem& problem_;
    const std::vector<Parameter>& parameters_;
    NoiseModel& noise_;
    const GaussNewtonOptions& options_;
    const ProgressSink& progress_;
    TransformedRange range_;
    TransformedPriors priors_;
    std::vector<bool> is_held_;
    Eigen::VectorXd
        scale_;  ///< [num_parameter] the largest curvature that was met, on the diagonal
    double damping_, growth_ = 2;
    double reach_ = 1;                ///< share of the longest allowed step that may be used
    std::vector<double> objectives_;  ///< F at the start and after each trial
    GaussNewtonMinimum now_;
};

void GaussNewtonSearch::begin(const GaussNewtonStart& start) {
    std::string failure;
    now_.prediction = start.warm;
    const auto prediction = is_complete(start) ? start.warm : predict(start.values, failure);
    if (!prediction) {
        std::string place;
        for (std::size_t k = 0; k < parameters_.size(); ++k)
            place += fmt::format("{}{} = {:g}", k == 0 ? "" : ", ", label_of(parameters_[k]),
                                 start.values[static_cast<Index>(k)]);
        throw Error(ErrorCode::solve_failed,
                    fmt::format("the model has no prediction at the start ({}): {}; give another "
                                "start",
                                place, failure));
    }
    scale_ = Eigen::VectorXd::Zero(start.values.size());
    now_.prediction = prediction;
    noise_.reweight(*prediction);
    linearise();
}

/// Everything that is known at the prediction `now_` stands at.
void GaussNewtonSearch::linearise() {
    now_.values = now_.prediction->values;
    now_.transformed = to_transformed(parameters_, now_.values);
    now_.equations = normal_equations(parameters_, *now_.prediction, noise_);
    now_.objective = minus_log_posterior(parameters_, *now_.prediction, noise_);
    scale_ = now_.equations.hessian.diagonal();
}

std::shared_ptr<const Prediction> GaussNewtonSearch::predict(const Eigen::VectorXd& values,
                                                             std::string& failure,
                                                             bool keeps_columns) {
    check_cancelled(progress_);
    ++now_.num_prediction;
    const PredictionAttempt made = checked_prediction(
        problem_, values, keeps_columns ? PredictedColumns::none : PredictedColumns::wanted,
        now_.prediction.get());
    if (made.prediction)
        return keeps_columns ? with_columns_of(now_.prediction, made.prediction, parameters_)
                             : made.prediction;
    ++now_.num_failed;
    failure = made.failure;
    return nullptr;
}

/// (t - t_c)^T H (t - t_c) / 2 with t_c where the columns were made, and what is left to gain.
bool GaussNewtonSearch::keeps_columns_at(const Eigen::VectorXd& transformed) const {
    const double within = options_.keeps_columns_within;
    if (!(now_.predicted_gain < within)) return false;
    const Eigen::VectorXd away =
        transformed - to_transformed(parameters_, place_of_columns(*now_.prediction));
    return 0.5 * away.dot(now_.equations.hessian * away) < within;
}

std::vector<Index> GaussNewtonSearch::free_parameters() const {
    std::vector<Index> free;
    for (Index k = 0; k < now_.transformed.size(); ++k)
        if (!is_held_[k] && !stands_at_end(range_, now_.transformed, now_.equations.gradient, k))
            free.push_back(k);
    return free;
}

/// g^T H^-1 g / 2 over the free parameters: what the undamped step would gain. Directions without
/// curvature gain nothing that could be told.
void GaussNewtonSearch::measure_gain(const std::vector<Index>& free) {
    now_.predicted_gain = 0;
    if (free.empty()) return;
    const Eigen::MatrixXd hessian = now_.equations.hessian(free, free);
    const Eigen::VectorXd unit =
        hessian.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.asDiagonal() * hessian *
                                                               unit.asDiagonal());
    const Eigen::VectorXd slopes =
        eigen.eigenvectors().transpose() * unit.cwiseProduct(now_.equations.gradient(free));
    const double least = flat_curvature * eigen.eigenvalues().maxCoeff();
    for (Index k = 0; k < slopes.size(); ++k)
        if (eigen.eigenvalues()[k] > least)
            now_.predicted_gain += 0.5 * slopes[k] * slopes[k] / eigen.eigenvalues()[k];
}

Eigen::VectorXd GaussNewtonSearch::damped_step(const std::vector<Index>& free) const {
    // (H + lambda diag(scale)) d = -g
    Eigen::MatrixXd damped = now_.equations.hessian(free, free);
    damped.diagonal() += damping_ * scale_(free).cwiseMax(std::numeric_limits<double>::min());
    Eigen::VectorXd step = Eigen::VectorXd::Zero(now_.transformed.size());
    step(free) = -damped.ldlt().solve(now_.equations.gradient(free));
    return step;
}

/// F up to what does not change while the noise is held.
double GaussNewtonSearch::held_objective(const Prediction& prediction) const {
    return noise_.misfit(prediction) +
           priors_.energy(to_transformed(parameters_, prediction.values));
}

double GaussNewtonSearch::enough_gain() const {
    return std::max(options_.gain_tolerance, options_.gain_share * noise_.misfit(*now_.prediction));
}

bool GaussNewtonSearch::try_step(const std::vector<Index>& free) {
    const Eigen::VectorXd step =
        allowed_step(parameters_, now_.transformed, damped_step(free), options_.max_change, reach_);
    const double before = held_objective(*now_.prediction),
                 promised = quadratic_gain(now_.equations, step);
    GaussNewtonTrial trial{std::numeric_limits<double>::infinity(), now_.predicted_gain, damping_,
                           false, ""};
    const Eigen::VectorXd next = now_.transformed + step;
    const auto made = predict(to_values(parameters_, next), trial.failure, keeps_columns_at(next));
    const double after = made ? held_objective(*made) : trial.objective;
    const double gain = before - after;
    // Where F no longer resolves what is left to gain, the quadratic is trusted.
    const double unresolved = resolution * std::abs(before);
    trial.accepted = promised > 0 && (gain > 0 || (promised < unresolved && gain > -unresolved));
    if (trial.accepted)
        accept(made, gain > unresolved ? gain / promised : 1.0);
    else
        reject(!made);
    trial.objective = trial.accepted ? now_.objective : after;
    now_.trials.push_back(trial);
    objectives_.push_back(now_.objective);
    return trial.accepted || renew_columns();
}

/// After a step that was rejected: where the columns are those of another place, the gradient may
/// be none of this one. False where they are its own, or cannot be had.
bool GaussNewtonSearch::renew_columns() {
    if (!now_.prediction->columns_of) return false;
    std::string failure;
    const auto own = predict(now_.values, failure);
    if (!own) return false;
    now_.prediction = own;
    linearise();
    damping_ = options_.first_damping;
    growth_ = 2;
    reach_ = 1;
    objectives_ = {now_.objective};
    return true;
}

/// lambda falls by up to 3 where the quadratic is right, and rises where it is not (Madsen et al.).
void GaussNewtonSearch::accept(std::shared_ptr<const Prediction> prediction, double ratio) {
    now_.prediction = std::move(prediction);
    noise_.reweight(*now_.prediction);
    linearise();
    damping_ *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * ratio - 1.0, 3));
    growth_ = 2;
    reach_ = std::min(1.0, 2.0 * reach_);
}

/// A step that has no prediction at all asks for far more damping than one that gains too little.
void GaussNewtonSearch::reject(bool has_failed) {
    damping_ = has_failed ? std::max(10.0 * damping_, 0.1) : damping_ * growth_;
    growth_ = 2.0 * growth_;
    reach_ *= 0.5;
}

bool GaussNewtonSearch::is_idle() const {
    const std::size_t count = objectives_.size();
    if (count <= most_idle_trials) return false;
    return objectives_[count - 1 - most_idle_trials] - objectives_.back() < options_.gain_tolerance;
}

void GaussNewtonSearch::report() const {
    report_progress(
        progress_, "searching", -1,
        fmt::format("step {}: ln posterior {:.3f}, {:.3g} to gain, damping {:.1g}",
                    now_.trials.size(), -now_.objective, now_.predicted_gain, damping_));
}

/// The least that the last trials promised to gain.
double GaussNewtonSearch::least_promised() const {
    double least = now_.predicted_gain;
    for (std::size_t k = now_.trials.size() - most_idle_trials; k < now_.trials.size(); ++k)
        least = std::min(least, now_.trials[k].predicted_gain);
    return least;
}

GaussNewtonMinimum GaussNewtonSearch::run() {
    objectives_.push_back(now_.objective);
    while (true) {
        const std::vector<Index> free = free_parameters();
        measure_gain(free);
        report();
        if (now_.predicted_gain < enough_gain()) {
            now_.ending = Ending::converged;
            break;
        }
        bool has_moved = false;
        while (!has_moved && static_cast<int>(now_.trials.size()) < options_.max_steps &&
               !is_exhausted() && !is_idle())
            has_moved = try_step(free);
        if (has_moved) continue;
        if (is_idle() && !is_exhausted()) {
            now_.ending = least_promised() < most_promised ? Ending::converged : Ending::stalled;
            break;
        }
        const bool is_resolved = now_.predicted_gain > 10 * resolution * std::abs(now_.objective);
        now_.ending = !is_exhausted() ? Ending::too_many_steps
                      : is_resolved   ? Ending::stalled
                                      : Ending::converged;
        break;
    }
    return std::move(now_);
}

}  // namespace

const char* name_of(Ending ending) {
    switch (ending) {
        case Ending::converged:
            return "converged";
        case Ending::too_many_steps:
            return "too many steps";
        case Ending::stalled:
            return "stalled";
    }
    return "stalled";
}

GaussNewtonMinimum minimise_gauss_newton(const DataProblem& problem, NoiseModel& noise,
                                         const GaussNewtonStart& start,
                                         const GaussNewtonOptions& options,
                                         const ProgressSink& progress) {
    return GaussNewtonSearch(problem, noise, start, options, progress).run();
}

}  // namespace palpate
