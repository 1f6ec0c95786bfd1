// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/poisson_search.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "host/estimate/posterior.hpp"
#include "host/estimate/trust_region.hpp"

namespace palpate {
namespace {

/// Residuals of trials whose objective is this much above the lowest count half as much in the
/// paraboloid.
constexpr double trusted_rise = 4.0;

const RatioTrial& lowest_of(const std::vector<RatioTrial>& trials) {
    return *std::min_element(trials.begin(), trials.end(), [](const auto& a, const auto& b) {
        return a.objective < b.objective;
    });
}

std::vector<RatioTrial> go_down(const RatioEvaluation& evaluate, const Eigen::VectorXd& start,
                                const RatioSearchOptions& options, bool& converged) {
    std::vector<RatioTrial> trials;
    const auto objective = [&](const Eigen::VectorXd& ratios) {
        trials.push_back(evaluate(ratios));
        return trials.back().objective;
    };
    converged = minimise_in_trust_region(objective, start,
                                         {options.lowest, options.highest, options.first_step,
                                          options.tolerance, options.max_evaluations})
                    .converged;
    return trials;
}

/// f(x) = f_0 + g . d + 1/2 d . H d with d = x - best, by weighted least squares.
struct Paraboloid {
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;
};

/// The weight of a trial in the fits, from its rise above the lowest.
double weight_of(double rise) { return 1.0 / (1.0 + rise / trusted_rise); }

Paraboloid paraboloid(const std::vector<RatioTrial>& trials) {
    const RatioTrial& best = lowest_of(trials);
    const Eigen::Index n = best.ratios.size(), count = trials.size();
    Eigen::MatrixXd terms(count, 1 + n + n * (n + 1) / 2);
    Eigen::VectorXd values(count);
    for (Eigen::Index t = 0; t < count; ++t) {
        const RatioTrial& trial = trials[t];
        const Eigen::VectorXd d = trial.ratios - best.ratios;
        Eigen::Index term = 0;
        terms(t, term++) = 1;
        for (Eigen::Index i = 0; i < n; ++i) terms(t, term++) = d[i];
        for (Eigen::Index i = 0; i < n; ++i)
            for (Eigen::Index j = 0; j <= i; ++j)
                terms(t, term++) = (i == j ? 0.5 : 1.0) * d[i] * d[j];
        values[t] = trial.objective - best.objective;
        const double weight = weight_of(values[t]);
        terms.row(t) *= weight;
        values[t] *= weight;
    }
    const Eigen::VectorXd found = terms.completeOrthogonalDecomposition().solve(values);
    Paraboloid result{found.segment(1, n), Eigen::MatrixXd(n, n)};
    Eigen::Index term = 1 + n;
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j <= i; ++j)
            result.hessian(i, j) = result.hessian(j, i) = found[term++];
    return result;
}

/// Inverse of the Hessian, whose curvature is taken to be at least `smallest`.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& hessian, double smallest) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
    const Eigen::VectorXd curvature = eigen.eigenvalues().cwiseMax(smallest);
    return eigen.eigenvectors() * curvature.cwiseInverse().asDiagonal() *
           eigen.eigenvectors().transpose();
}

/// Where slope d + 1/2 d^2 / variance reaches `profile_rise`, for d > 0.
double reach(double slope, double variance) {
    return variance * (std::sqrt(slope * slope + 2.0 * profile_rise / variance) - slope);
}

RatioLimit limit_of(double best, const RatioSearchOptions& options) {
    constexpr double margin = 0.004;
    if (best < options.lowest + margin) return RatioLimit::lowest;
    return best > options.highest - margin ? RatioLimit::highest : RatioLimit::none;
}

/// Along one ratio, the others following the ridge. Only at a limit may the best ratio have a
/// slope, that is one which goes up to the inside.
std::array<double, 2> reach_of(const Paraboloid& fit, Eigen::Index k, RatioLimit limit,
                               const RatioSearchOptions& options) {
    const double range = options.highest - options.lowest;
    const double variance = inverse_of(fit.hessian, 2.0 * profile_rise / (range * range))(k, k);
    const double up = limit == RatioLimit::lowest ? std::max(0.0, fit.gradient[k]) : 0.0;
    const double down = limit == RatioLimit::highest ? std::max(0.0, -fit.gradient[k]) : 0.0;
    return {reach(down, variance), reach(up, variance)};
}

/// Where ratio k is `value` and the others follow: nu_j + C_jk / C_kk (value - nu_k).
Eigen::VectorXd along_ridge(const RatioPosterior& posterior, Eigen::Index k, double value,
                            const RatioSearchOptions& options) {
    const Eigen::VectorXd& best = posterior.best.ratios;
    const Eigen::VectorXd ridge = posterior.covariance.col(k) / posterior.covariance(k, k);
    Eigen::VectorXd ratios = best + (value - best[k]) * ridge;
    ratios = ratios.cwiseMax(options.lowest).cwiseMin(options.highest);
    ratios[k] = value;
    return ratios;
}

/// Trials on both sides of the best ratio k, from it outwards, so that each starts near the last.
RatioScan scan_of(const RatioEvaluation& evaluate, const RatioPosterior& posterior, Eigen::Index k,
                  const RatioTrial& best, const RatioSearchOptions& options) {
    constexpr double least_step = 0.004;  // none nearer to each other
    std::vector<RatioTrial> trials{best};
    for (const double side : {-1.0, 1.0}) {
        double last = best.ratios[k];
        for (const double of_reach : {0.7, 1.5}) {
            const double reach = posterior.reach[k][side < 0 ? 0 : 1];
            const double value = std::clamp(best.ratios[k] + side * of_reach * reach,
                                            options.lowest, options.highest);
            if (std::abs(value - last) < least_step) continue;
            trials.push_back(evaluate(along_ridge(posterior, k, value, options)));
            last = value;
        }
    }
    std::sort(trials.begin(), trials.end(),
              [&](const auto& a, const auto& b) { return a.ratios[k] < b.ratios[k]; });
    RatioScan scan;
    scan.lowest = options.lowest;
    scan.highest = options.highest;
    scan.theta.resize(best.theta.size(), trials.size());
    for (std::size_t t = 0; t < trials.size(); ++t) {
        scan.ratio.push_back(trials[t].ratios[k]);
        scan.rise.push_back(std::max(0.0, trials[t].objective - best.objective));
        scan.theta.col(t) = trials[t].theta - best.theta;
    }
    return scan;
}

}  // namespace

RatioPosterior search_ratios(const RatioEvaluation& evaluate, const Eigen::VectorXd& start,
                             const RatioSearchOptions& options) {
    RatioPosterior posterior;
    const std::vector<RatioTrial> trials = go_down(evaluate, start, options, posterior.converged);
    posterior.best = lowest_of(trials);
    const Paraboloid fit = paraboloid(trials);
    const double range = options.highest - options.lowest;
    posterior.covariance = inverse_of(fit.hessian, 12.0 / (range * range));
    for (Eigen::Index k = 0; k < start.size(); ++k) {
        posterior.at_limit.push_back(limit_of(posterior.best.ratios[k], options));
        posterior.reach.push_back(reach_of(fit, k, posterior.at_limit.back(), options));
    }
    posterior.evaluations = static_cast<int>(trials.size());
    return posterior;
}

std::vector<RatioScan> scan_ratios(const RatioEvaluation& evaluate, const RatioPosterior& posterior,
                                   const RatioSearchOptions& options) {
    const RatioTrial best = evaluate(posterior.best.ratios);
    std::vector<RatioScan> scans;
    for (Eigen::Index k = 0; k < posterior.best.ratios.size(); ++k)
        scans.push_back(scan_of(evaluate, posterior, k, best, options));
    return scans;
}

std::array<double, 2> with_ratio_model_error(const std::array<double, 2>& reach) {
    return {std::hypot(reach[0], 1.96 * ratio_model_sd),
            std::hypot(reach[1], 1.96 * ratio_model_sd)};
}

}  // namespace palpate
