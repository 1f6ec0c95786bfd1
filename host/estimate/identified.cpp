// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/identified.hpp"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/estimate/profile_search.hpp"
#include "host/estimate/satterthwaite.hpp"

namespace palpate {
namespace {

/// A direction whose curvature is below this share of the largest, parameters scaled, is unknown.
constexpr double unknown_curvature = 1e-14;
/// Share of its Huber weight that makes a row an outlier.
constexpr double outlier_weight = 0.999;

struct Curvature {
    Eigen::MatrixXd covariance;
    double log_determinant = 0;  ///< of H
};

/// Inverse and determinant of H, by eigenvalues of H scaled to a diagonal of 1.
Curvature invert_curvature(const Eigen::MatrixXd& hessian) {
    const Eigen::VectorXd unit = hessian.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.asDiagonal() * hessian *
                                                               unit.asDiagonal());
    const double floor = unknown_curvature * std::max(eigen.eigenvalues().maxCoeff(), 1.0);
    const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(floor);
    const Eigen::MatrixXd root =
        unit.asDiagonal() * eigen.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal();
    return {root * root.transpose(), values.array().log().sum() - 2.0 * unit.array().log().sum()};
}

/// With what is held known: C_oo - C_oh C_hh^-1 C_ho, and 0 of those that are held.
Eigen::MatrixXd with_held_known(const std::vector<Parameter>& parameters,
                                const Eigen::MatrixXd& covariance) {
    const std::vector<Index> held = held_of(parameters);
    if (held.empty()) return covariance;
    const Eigen::MatrixXd across = covariance(Eigen::all, held);
    const Eigen::LDLT<Eigen::MatrixXd> factor(Eigen::MatrixXd(covariance(held, held)));
    Eigen::MatrixXd known = covariance - across * factor.solve(across.transpose());
    for (const Index k : held) {
        known.row(k).setZero();
        known.col(k).setZero();
    }
    return known;
}

Eigen::MatrixXd correlation_of(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd unit = covariance.diagonal().cwiseSqrt().cwiseInverse();
    return unit.asDiagonal() * covariance * unit.asDiagonal();
}

/// The prior's 95 % interval on the parameter's own scale; infinite if flat.
std::array<double, 2> prior_interval_of(const Parameter& parameter) {
    if (!parameter.has_prior())
        return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    const double mean = to_transformed(parameter, parameter.median);
    return {std::max(parameter.lowest, to_value(parameter, mean - 1.96 * parameter.sd)),
            std::min(parameter.highest, to_value(parameter, mean + 1.96 * parameter.sd))};
}

std::string partner_words(const std::vector<Parameter>& parameters,
                          const IdentifiedParameter& found) {
    if (std::abs(found.partner_correlation) <= strong_correlation) return "";
    return fmt::format(
        "; it trades with {} (correlation {:.2f}): a combination of the two is known better than "
        "either",
        label_of(parameters[found.partner]), found.partner_correlation);
}

/// Verdict of a parameter that is bounded on both sides: by the factor that its interval spans
/// where its sign is known and it has no logit, else by the share of the prior's interval that is
/// left.
Judgement judge_bounded(const IdentifiedParameter& found, const std::string& trade) {
    const auto [low, high] = found.interval;
    const Parameter& parameter = found.parameter;
    const bool has_sign = low > 0 || high < 0;
    const bool goes_by_factor =
        parameter.transform == Transform::log ||
        (!parameter.has_prior() && has_sign && parameter.transform == Transform::identity);
    if (goes_by_factor) {
        const double span = low > 0 ? high / low : low / high;
        const Verdict verdict = verdict_of_span(span);
        return {verdict, fmt::format("the 95 % interval spans a factor of {:.{}f}{}", span,
                                     verdict == Verdict::weak ? 1 : 2, trade)};
    }
    if (!parameter.has_prior())
        return {Verdict::weak, fmt::format("not even its sign is known{}", trade)};
    const auto prior = prior_interval_of(parameter);
    const double share = (high - low) / (prior[1] - prior[0]);
    return {verdict_of_share(share),
            fmt::format("the data leave {:.0f} % of the spread that was assumed beforehand{}",
                        100 * std::min(share, 1.0), trade)};
}

void find_partner(const Eigen::MatrixXd& correlation, Index k, IdentifiedParameter& found) {
    for (Index j = 0; j < correlation.cols(); ++j) {
        if (j == k || std::abs(correlation(k, j)) <= std::abs(found.partner_correlation)) continue;
        found.partner = j;
        found.partner_correlation = correlation(k, j);
    }
}

TransformedInterval quadratic_interval(double centre, double half_width) {
    return {{centre - half_width, centre + half_width}, false, {false, false}, {0, 0}};
}

/// Each parameter's, `reach` [num_parameter] sd to either side. Profiles know what is held, and are
/// followed for what is asked for alone.
std::vector<TransformedInterval> intervals_of(const std::vector<Parameter>& parameters,
                                              const Fit& fit, const Eigen::VectorXd& sd,
                                              const Eigen::VectorXd& known_sd,
                                              const Eigen::VectorXd& reach, ProfileSearch& profiles,
                                              const IdentifyOptions& options) {
    std::vector<TransformedInterval> intervals;
    std::vector<WantedInterval> wanted;
    for (Index k = 0; k < sd.size(); ++k) {
        intervals.push_back(quadratic_interval(fit.transformed[k], reach[k] * sd[k]));
        const bool is_narrow = options.added_sd.size() > 0 && sd[k] < options.added_sd[k];
        if (is_narrow)
            intervals.back().rise = {0.5 * reach[k] * reach[k], 0.5 * reach[k] * reach[k]};
        else if (!parameters[k].is_nuisance && std::isfinite(options.skewness_tolerance))
            wanted.push_back({k, reach[k]});
    }
    const auto profiled = profiles.intervals(wanted, options.skewness_tolerance, options.jobs);
    for (std::size_t n = 0; n < wanted.size(); ++n) {
        const Index k = wanted[n].parameter;
        intervals[k] = profiled[n];
        for (double& end : intervals[k].ends)
            end = fit.transformed[k] + (end - fit.transformed[k]) * sd[k] / known_sd[k];
    }
    return intervals;
}

IdentifiedParameter identify_parameter(const std::vector<Parameter>& parameters, const Fit& fit,
                                       const Identified& all, double degrees,
                                       const TransformedInterval& interval, ProfileSearch& profiles,
                                       Index k, const IdentifyOptions& options) {
    IdentifiedParameter found;
    found.parameter = parameters[k];
    found.value = fit.values[k];
    found.sd = std::sqrt(all.covariance(k, k));
    find_partner(all.correlation, k, found);
    found.degrees_of_freedom = degrees;
    found.is_profiled = interval.is_profiled;
    found.is_cut = interval.is_cut;
    for (const int side : {0, 1})
        found.interval[side] = std::clamp(to_value(found.parameter, interval.ends[side]),
                                          found.parameter.lowest, found.parameter.highest);
    UnknownEvidence& evidence = found.evidence;
    evidence = {found.sd, found.parameter.sd, 0, true, true};
    if (options.judges_far_ends && !found.parameter.is_nuisance) {
        const auto excluded = profiles.excluded_ends(k, interval);
        evidence.excludes_low = excluded[0];
        evidence.excludes_high = excluded[1];
    }
    found.judgement = judge_parameter(parameters, found);
    if (found.parameter.has_prior() && !found.parameter.is_nuisance)
        found.interval = told_interval(found.interval, prior_interval_of(found.parameter), evidence,
                                       found.judgement.verdict);
    if (!std::isfinite(found.interval[0]) || !std::isfinite(found.interval[1]))
        found.judgement = {Verdict::not_identifiable,
                           "nothing that was measured depends on it, and nothing was assumed of it "
                           "beforehand"};
    return found;
}

BlockFit block_fit(const DataBlock& block, const NoiseModel& noise, Index b) {
    const Eigen::VectorXd residual = residual_of(block);
    BlockFit fit;
    fit.name = block.name;
    fit.kind = block.kind;
    fit.unit = block.unit;
    fit.num_row = block.num_row();
    if (fit.num_row == 0) return fit;
    fit.rms = residual.norm() / std::sqrt(static_cast<double>(fit.num_row));
    fit.chi_squared = residual.dot(noise.covariance(b).solve(residual).col(0));
    fit.chi_squared_noise = residual.cwiseQuotient(block.sd).squaredNorm();
    fit.discrepancy = noise.discrepancy(b);
    fit.num_outlier = static_cast<Index>((noise.weights(b).array() < outlier_weight).count());
    fit.effective_rows = effective_rows(noise.covariance(b));
    return fit;
}

/// ln Z = -F + p ln(2 pi) / 2 - ln det H / 2 (Laplace); BIC with the rows that count (Kass and
/// Raftery 1995, equations 5 and 9).
void weigh_model(const Fit& fit, const Curvature& curvature, const Eigen::VectorXd& known_sd,
                 Identified& all) {
    const double count = static_cast<double>(fit.values.size());
    all.log_evidence = -fit.objective + 0.5 * count * std::log(2.0 * std::numbers::pi) -
                       0.5 * curvature.log_determinant;
    for (std::size_t k = 0; k < all.parameters.size(); ++k) {
        const Parameter& parameter = all.parameters[k].parameter;
        if (!parameter.is_held)
            all.num_determined += 1.0 - std::pow(known_sd[Index(k)] / parameter.sd, 2);
    }
    for (const BlockFit& block : all.blocks) all.effective_rows += block.effective_rows;
    all.bic = 2.0 * (fit.noise->misfit(*fit.prediction) + fit.noise->normalisation()) +
              all.num_determined * std::log(std::max(all.effective_rows, 1.0));
}

}  // namespace

Judgement judge_parameter(const std::vector<Parameter>& parameters,
                          const IdentifiedParameter& found) {
    const std::string trade = partner_words(parameters, found);
    const std::string& unit = found.parameter.unit;
    switch (case_of(found.evidence)) {
        case EvidenceCase::unseen:
            return {Verdict::not_identifiable,
                    fmt::format("the data hardly narrow what was assumed beforehand (sd {:.2g} "
                                "against {:.2g} before){}",
                                found.evidence.sd, found.evidence.prior_sd, trade)};
        case EvidenceCase::lower_bound_only:
            return {Verdict::weak, fmt::format("only a lower bound is known, {:.3g} {}: larger "
                                               "values fit as well{}",
                                               found.interval[0], unit, trade)};
        case EvidenceCase::upper_bound_only:
            return {Verdict::weak, fmt::format("only an upper bound is known, {:.3g} {}: smaller "
                                               "values fit as well{}",
                                               found.interval[1], unit, trade)};
        case EvidenceCase::bounded:
            return judge_bounded(found, trade);
    }
    return {};
}

double effective_rows(const BlockCovariance& covariance) {
    // 1^T R^-1 1 = c^T C^-1 c with c the root of C's diagonal
    const Eigen::VectorXd root = covariance.variances().cwiseSqrt();
    return std::clamp(root.dot(covariance.solve(root).col(0)), 1.0,
                      static_cast<double>(root.size()));
}

Identified identify(const DataProblem& problem, const Fit& fit, const IdentifyOptions& options,
                    const ProgressSink& progress) {
    const std::vector<Parameter>& parameters = problem.parameters();
    const auto count = static_cast<Index>(parameters.size());
    const Curvature curvature = invert_curvature(fit.equations.hessian);
    Identified all;
    all.covariance = curvature.covariance;
    all.correlation = correlation_of(all.covariance);
    const std::vector<Index> held = held_of(parameters);
    Eigen::MatrixXd information = fit.equations.information;
    for (const Index k : held) {  // data tell nothing of these
        information.row(k).setZero();
        information.col(k).setZero();
    }
    const ScaledSensitivity sensitivity =
        prior_scaled_sensitivity(parameters, fit.values, information);
    all.singular_values = sensitivity.singular_values;
    all.best_known = combination_of(parameters, fit.values, all.covariance, sensitivity, 0);
    all.weakest = combination_of(parameters, fit.values, all.covariance, sensitivity,
                                 std::max<Index>(0, count - 1 - Index(held.size())));
    const Eigen::VectorXd degrees = degrees_of_freedom(parameters, fit);
    const Eigen::MatrixXd known = with_held_known(parameters, all.covariance);
    const Eigen::VectorXd known_sd = known.diagonal().cwiseMax(0.0).cwiseSqrt();
    ProfileSearch profiles(problem, fit, known, options.gauss_newton, options.guide, progress);
    const auto intervals = intervals_of(
        parameters, fit, all.covariance.diagonal().cwiseSqrt(), known_sd,
        degrees.unaryExpr([](double of) { return student_reach(of); }), profiles, options);
    for (Index k = 0; k < count; ++k)
        all.parameters.push_back(identify_parameter(parameters, fit, all, degrees[k], intervals[k],
                                                    profiles, k, options));
    for (Index b = 0; b < fit.noise->num_block(); ++b)
        all.blocks.push_back(block_fit(fit.prediction->blocks[b], *fit.noise, b));
    weigh_model(fit, curvature, known_sd, all);
    all.num_prediction = profiles.num_prediction();
    return all;
}

}  // namespace palpate
