// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/judged_modulus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/apps/recover/inverse/identifiability.hpp"
#include "host/apps/recover/inverse/model_error.hpp"
#include "host/apps/recover/modelling/regions.hpp"

namespace palpate {
namespace {

/// What is known of unknown `k` where one search has ended, and is to be told, were its moduli
/// changed by `shift_ln`. `mesh_change_ln`: what elements of no size would change of them.
ModulusAnswer answer_at(const MapEstimate& estimate, Index k, const Eigen::VectorXd& mesh_change_ln,
                        const Eigen::VectorXd& shift_ln) {
    const Eigen::VectorXd theta = estimate.theta + shift_ln;
    Eigen::VectorXd model_sd(theta.size());
    for (Index j = 0; j < theta.size(); ++j)
        model_sd[j] = model_sd_ln_with(estimate.noise_level.contour_mm, mesh_change_ln[j]);
    const BelievedModuli believed =
        believed_moduli(theta, estimate.covariance, estimate.unknown, model_sd);
    KnownModulus found{std::exp(theta[k]), estimate.interval_kpa[k],
                       std::sqrt(estimate.covariance(k, k))};
    for (double& end : found.interval_kpa) end *= std::exp(shift_ln[k]);
    const KnownModulus told =
        with_model_error(found, std::exp(believed.mean[k]), estimate.unknown[k].sd, model_sd[k]);
    ModulusEvidence evidence;
    evidence.interval_kpa = told.interval_kpa;
    evidence.sd_ln = told.sd_ln;
    evidence.prior_sd_ln = estimate.unknown[k].sd;
    evidence.seen_sd_ln = estimate.seen_sd_ln[k];
    evidence.excludes_soft = estimate.excluded_ends[k][0];
    evidence.excludes_stiff = estimate.excluded_ends[k][1];
    return {told.kpa, evidence, found.kpa, std::sqrt(believed.covariance(k, k))};
}

/// Of what tells something, whether the images may have misled: then the answer is the mixture of
/// both (with_misled_data).
void doubt(ModulusAnswer& answer, const Unknown& prior) {
    ModulusEvidence& evidence = answer.evidence;
    const double left = std::max({evidence.sd_ln, evidence.seen_sd_ln, answer.believed_sd_ln});
    if (!(left <= unseen_share * prior.sd)) return;
    const auto doubted = with_misled_data({answer.kpa, evidence.interval_kpa, evidence.sd_ln},
                                          answer.believed_sd_ln, prior);
    if (!doubted || doubted->misled_probability < contradiction_probability) return;
    const auto& [known, probability] = *doubted;
    evidence.contradiction = {probability, answer.end_kpa, std::log(answer.end_kpa) > prior.mean};
    evidence.interval_kpa = known.interval_kpa;
    evidence.sd_ln = known.sd_ln;
    answer.kpa = known.kpa;
}

/// What is known of unknown `k`, other searches' ends and its strongest partner among the other
/// unknown moduli included. What the mesh changes is known at the first end and taken to be the
/// same at the others.
ModulusAnswer answer_of(const MapEstimate& estimate, std::size_t k, const Settings& settings) {
    const Index row = static_cast<Index>(k);
    const Eigen::MatrixXd& covariance = estimate.covariance;
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(estimate.theta.size());
    const Eigen::VectorXd& mesh_change =
        estimate.mesh_change_ln.size() > 0 ? estimate.mesh_change_ln : nothing;
    std::vector<ModulusAnswer> others;
    for (const auto& other : estimate.others)
        others.push_back(answer_at(*other, row, mesh_change, mesh_change));
    ModulusAnswer answer = answer_at(estimate, row, mesh_change, nothing);
    ModulusEvidence& evidence = answer.evidence;
    evidence = evidence_with(answer, others);
    if (evidence.other_kpa.empty()) doubt(answer, estimate.unknown[k]);
    for (Index other = 0; other < covariance.cols(); ++other) {
        const double correlation =
            covariance(row, other) / std::sqrt(covariance(row, row) * covariance(other, other));
        if (other == row || std::abs(correlation) <= std::abs(evidence.partner_correlation))
            continue;
        evidence.partner_correlation = correlation;
        evidence.partner = name_of_region(settings, estimate.unknown[other].object);
    }
    return answer;
}

void tell(const Judgement& verdict, RegionResult& result) {
    result.verdict = verdict.verdict;
    result.reason = verdict.reason;
}

}  // namespace

bool has_known_tissue(const Settings& settings) {
    if (settings.background) return true;
    return std::any_of(settings.organs.begin(), settings.organs.end(), [](const auto& organ) {
        return !organ.hollow && organ.stiffness_kpa.has_value();
    });
}

std::string why_told_alone(const MapEstimate& estimate, const Settings& settings) {
    if (estimate.interval_kpa.empty()) return "";
    for (std::size_t k = 0; k < estimate.unknown.size(); ++k) {
        const ModulusEvidence evidence = answer_of(estimate, k, settings).evidence;
        if (!evidence.other_kpa.empty()) return "has more than one answer";
        if (evidence.contradiction) return "contradicts what was assumed beforehand";
    }
    return "";
}

void judge_modulus(const MapEstimate& estimate, std::size_t k, const Settings& settings,
                   RegionResult& result) {
    result.most_probable_kpa = std::exp(estimate.theta[static_cast<Index>(k)]);
    result.stiffness_kpa = result.most_probable_kpa;
    if (estimate.interval_kpa.empty()) {
        result.sd_ln = std::numeric_limits<double>::quiet_NaN();
        result.interval_kpa = {result.sd_ln, result.sd_ln};
        return tell(not_judged("nested-lbfgs"), result);
    }
    const ModulusAnswer answer = answer_of(estimate, k, settings);
    const ModulusEvidence& evidence = answer.evidence;
    const Judgement verdict = judge(evidence);
    result.stiffness_kpa = answer.kpa;
    result.interval_kpa = told_interval(evidence, verdict, std::exp(estimate.unknown[k].mean));
    const bool is_told =
        verdict.verdict != Verdict::not_identifiable && !evidence.contradiction.has_value();
    result.seen_ends = {is_told && evidence.excludes_soft, is_told && evidence.excludes_stiff};
    result.other_answers_kpa = evidence.other_kpa;
    result.contradicts_prior = evidence.contradiction.has_value();
    result.sd_ln = verdict.verdict == Verdict::not_identifiable
                       ? std::max(evidence.sd_ln, evidence.seen_sd_ln)
                       : evidence.sd_ln;
    tell(verdict, result);
}

}  // namespace palpate
