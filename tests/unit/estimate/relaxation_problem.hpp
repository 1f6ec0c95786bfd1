// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <memory>
#include <random>

#include "host/estimate/fit.hpp"
#include "host/estimate/identified.hpp"
#include "toy_problem.hpp"

namespace palpate {

/// A force that relaxes with two times: f (1 - g_1 (1 - exp(-t / tau_1)) - g_2 (1 - exp(-t /
/// tau_2))).
inline std::vector<Parameter> relaxation_parameters() {
    return {log_parameter("f", 100, 100, 0.5), log_parameter("g1", 0.3, 0.3, 0.4),
            log_parameter("tau1", 1, 1, 0.4), log_parameter("g2", 0.3, 0.3, 0.4),
            log_parameter("tau2", 10, 10, 0.4)};
}

inline ToyProblem relaxation_problem(const Eigen::VectorXd& times, double sd) {
    DataBlock block = toy_block(Eigen::VectorXd::Zero(times.size()), sd);
    block.time_s = times;
    return {relaxation_parameters(), block, [times](const auto& v, Index row) {
                const double t = times[row];
                return v[0] * (1.0 - v[1] * (1.0 - std::exp(-t / v[2])) -
                               v[3] * (1.0 - std::exp(-t / v[4])));
            }};
}

/// Correlated noise that the kernel of the discrepancy does not have.
enum class OtherNoise { squared_exponential, autoregressive };

inline Eigen::VectorXd draw_other_noise(OtherNoise kind, const Eigen::VectorXd& times, double sd,
                                        double length_s, std::mt19937& random) {
    std::normal_distribution<double> normal;
    const auto count = times.size();
    Eigen::MatrixXd covariance(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < count; ++j) {
            const double apart = std::abs(times[i] - times[j]) / length_s;
            covariance(i, j) = kind == OtherNoise::autoregressive ? std::exp(-apart)
                                                                  : std::exp(-0.5 * apart * apart);
        }
    covariance.diagonal().array() += 1e-8;
    Eigen::VectorXd white(count);
    for (auto& number : white) number = normal(random);
    const Eigen::VectorXd drawn = covariance.llt().matrixL() * white;
    return sd * drawn;
}

/// Shares of 95 % intervals that hold the truth.
struct Coverage {
    Eigen::VectorXd share;  ///< [num_parameter]
    double all = 0;
    double median_sd = 0;  ///< of ln f
};

struct CoverageCase {
    OtherNoise kind;
    double length_s;
    int num_draw = 200;
    bool learns_discrepancy = true;
    double noise_sd = 0.2, discrepancy_sd = 1.0;
    int num_time = 120;
};

inline Coverage coverage_of(const CoverageCase& at) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(at.num_time, 0.25, 30);
    ToyProblem problem = relaxation_problem(times, at.noise_sd);
    Coverage coverage{Eigen::VectorXd::Zero(5)};
    std::vector<double> widths;
    for (int draw = 0; draw < at.num_draw; ++draw) {
        // Truths from narrower priors than the fit has, so that g_1 + g_2 < 1.
        Eigen::VectorXd truth = starts_of(problem.parameters());
        for (auto& value : truth) value *= std::exp(0.3 * normal(random));
        problem.data().measured =
            problem.predict(truth, PredictedColumns::none, nullptr)
                .prediction->blocks[0]
                .predicted +
            draw_other_noise(at.kind, times, at.discrepancy_sd, at.length_s, random);
        for (auto& value : problem.data().measured) value += at.noise_sd * normal(random);
        FitOptions options;
        options.discrepancy.is_learned = at.learns_discrepancy;
        const Fit found = fit(problem, options);
        IdentifyOptions identification;
        identification.judges_far_ends = false;
        const Identified known = identify(problem, found, identification);
        for (Index k = 0; k < 5; ++k) {
            const auto& interval = known.parameters[k].interval;
            coverage.share[k] += interval[0] <= truth[k] && truth[k] <= interval[1];
        }
        widths.push_back(known.parameters[0].sd);
    }
    std::nth_element(widths.begin(), widths.begin() + at.num_draw / 2, widths.end());
    coverage.median_sd = widths[at.num_draw / 2];
    coverage.share /= at.num_draw;
    coverage.all = coverage.share.mean();
    return coverage;
}

}  // namespace palpate
