// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/springs/springs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/estimate/posterior.hpp"
#include "solver/base/error.hpp"

// Two springs in series hang on a wall. A known force F (mN) pulls at the end; how far the joint
// between them and the end move is measured, several times, with normal errors of known spread.
//     wall --k_1-- joint --k_2-- end --> F
namespace palpate {
namespace {

// 1. The table: all that can be said to the program.
const std::vector<Option> spring_options = {
    Option::number("force_mn", "mN", {0, 1e6, true}, "Force that pulls at the end").required(),
    Option::number("end_mm", "mm", any_number, "How far the end moved, once for each measurement")
        .list(1, Option::any_count)
        .required(),
    Option::number("joint_mm", "mm", any_number,
                   "How far the joint of the two springs moved, once for each measurement; without "
                   "it only their sum is known")
        .list(1, Option::any_count),
    Option::number("noise_mm", "mm", {0, 1e3, true}, "Standard deviation of each measurement")
        .usually(0.1),
    Option::number("median_mn_per_mm", "mN/mm", {0, 1e6, true},
                   "Median of the stiffness of a spring, as far as is known before measuring")
        .usually(10.0),
    Option::number("sd_ln", "", {0, 10, true},
                   "Standard deviation of the logarithm of a stiffness before measuring")
        .usually(1.2),
};

// 2. The inverse problem: minus the logarithm of the posterior and its derivatives.
class TwoSprings : public Objective {
public:
    explicit TwoSprings(const OptionValues& values)
        : force_mn_(values.number("force_mn")),
          weight_(1 / (values.number("noise_mm") * values.number("noise_mm"))),
          joint_mm_(values.numbers("joint_mm")),
          end_mm_(values.numbers("end_mm")) {
        const double mean = std::log(values.number("median_mn_per_mm"));
        unknowns_ = {{0, mean, values.number("sd_ln")}, {1, mean, values.number("sd_ln")}};
    }

    const std::vector<Unknown>& unknowns() const override { return unknowns_; }

    // F(theta) = sum_i (r_i / s)^2 / 2 + sum_k ((theta_k - m_k) / sd_k)^2 / 2,  r = model -
    // measured
    Evaluation evaluate(const Eigen::VectorXd& theta, bool) const override {
        const Eigen::Vector2d a = stretch_mm(theta);
        const auto [r1, r2] = sums_of_residuals(a);
        Evaluation at;
        at.objective =
            misfit(joint_mm_, a[0]) + misfit(end_mm_, a[0] + a[1]) + prior_energy(unknowns_, theta);
        at.gradient = Eigen::Vector2d(-a[0] * (r1 + r2), -a[1] * r2) * weight_;
        for (Index k = 0; k < 2; ++k)
            at.gradient[k] += (theta[k] - unknowns_[k].mean) * prior_precision(k);
        return at;
    }

    std::vector<double> objectives(const std::vector<Eigen::VectorXd>& thetas) const override {
        std::vector<double> values;
        for (const auto& theta : thetas) values.push_back(evaluate(theta, false).objective);
        return values;
    }

    // d2F/dtheta2 = J^T J / s^2 + sum_i r_i d2(model_i)/dtheta2 / s^2 + prior;  d2a/dtheta2 = a
    Eigen::MatrixXd hessian(const Eigen::VectorXd& theta) const override {
        const Eigen::Vector2d a = stretch_mm(theta);
        const auto [r1, r2] = sums_of_residuals(a);
        Eigen::MatrixXd curvature = seen_information(theta);
        curvature.diagonal() += Eigen::Vector2d(a[0] * (r1 + r2), a[1] * r2) * weight_;
        for (Index k = 0; k < 2; ++k) curvature(k, k) += prior_precision(k);
        return curvature;
    }

    // J^T J / s^2: rows of J are (-a_1, 0) of the joint and (-a_1, -a_2) of the end.
    Eigen::MatrixXd seen_information(const Eigen::VectorXd& theta) const override {
        const Eigen::Vector2d a = stretch_mm(theta);
        Eigen::MatrixXd information = double(end_mm_.size()) * a * a.transpose();
        information(0, 0) += double(joint_mm_.size()) * a[0] * a[0];
        return information * weight_;
    }

private:
    // theta = (ln k_1, ln k_2);  a_k = F / k_k;  joint = a_1,  end = a_1 + a_2
    Eigen::Vector2d stretch_mm(const Eigen::VectorXd& theta) const {
        return {force_mn_ * std::exp(-theta[0]), force_mn_ * std::exp(-theta[1])};
    }
    std::pair<double, double> sums_of_residuals(const Eigen::Vector2d& a) const {
        return {residual_sum(joint_mm_, a[0]), residual_sum(end_mm_, a[0] + a[1])};
    }
    static double residual_sum(const std::vector<double>& measured, double model) {
        double sum = 0;
        for (const double one : measured) sum += model - one;
        return sum;
    }
    double misfit(const std::vector<double>& measured, double model) const {
        double sum = 0;
        for (const double one : measured) sum += (model - one) * (model - one);
        return weight_ * sum / 2;
    }
    double prior_precision(Index k) const { return 1 / (unknowns_[k].sd * unknowns_[k].sd); }

    double force_mn_, weight_;
    std::vector<double> joint_mm_, end_mm_;
    std::vector<Unknown> unknowns_;
};

// 3. What is known of one spring: value, 95 % interval, verdict.
Figure stiffness_figure(const TwoSprings& problem, const Minimum& minimum, const Bounds& bounds,
                        Index k) {
    const Eigen::MatrixXd covariance = laplace_covariance(problem, minimum.theta);
    const Unknown& prior = problem.unknowns()[k];
    const double left = std::sqrt(covariance(k, k)) / prior.sd;
    const auto excluded = excluded_ends(problem, minimum.theta, covariance, k, bounds);
    std::array<double, 2> ends =
        profile_interval(profile_of(problem, minimum.theta, covariance, k), minimum.theta[k]);
    Figure figure{.name = k == 0 ? "first_mn_per_mm" : "second_mn_per_mm",
                  .value = std::exp(minimum.theta[k]),
                  .unit = "mN/mm",
                  .title = k == 0 ? "Stiffness of the first spring" : "Of the second spring"};
    if (left > 2.0 / 3.0) {
        ends = {prior.mean - 1.96 * prior.sd, prior.mean + 1.96 * prior.sd};
        figure.verdict = Verdict::not_identifiable;
        figure.reason = "the measurements hardly narrow what was assumed beforehand";
    } else if (!excluded[0] || !excluded[1]) {
        figure.verdict = Verdict::weak;
        figure.reason = "the measurements bound it on one side only, or not without the prior";
    } else {
        const bool is_narrow = ends[1] - ends[0] <= std::log(2.0);
        figure.verdict = is_narrow ? Verdict::recovered : Verdict::weak;
        figure.reason = is_narrow ? "the 95 % interval spans at most a factor of 2"
                                  : "the 95 % interval spans more than a factor of 2";
    }
    figure.interval_95 = {std::exp(ends[0]), std::exp(ends[1])};
    return figure;
}

// 4. The row from values to the result.
Outcome run_springs(const OptionValues& values, const ProgressSink& progress) {
    const TwoSprings problem(values);
    const double mean = problem.unknowns()[0].mean, reach = 8 * problem.unknowns()[0].sd;
    const Bounds bounds = same_bounds(2, mean - reach, mean + reach);
    report_progress(progress, "searching", 0, "the most probable stiffness");
    const Minimum minimum = minimise_bfgs(problem, scan_grid(problem, bounds), bounds);
    Outcome outcome;
    outcome.result.name = "springs";
    outcome.result.title = "Two springs in series";
    for (const Index k : {0, 1}) outcome.result.add(stiffness_figure(problem, minimum, bounds, k));
    constexpr double near_minimum = 0.01;  // in standard deviations of the posterior
    const bool converged = minimum.gradient_norm < near_minimum;
    outcome.result.add("converged", converged);
    if (!converged) outcome.exit_code = exit_code_not_converged;
    return outcome;
}

}  // namespace

Application springs_application() {
    return {"springs", "Stiffness of two springs in series from how far a known force moves them",
            spring_options, run_springs};
}

}  // namespace palpate
