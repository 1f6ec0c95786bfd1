// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/identifiability.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

UnknownEvidence general_evidence(const ModulusEvidence& evidence) {
    return {evidence.sd_ln, evidence.prior_sd_ln, evidence.seen_sd_ln, evidence.excludes_soft,
            evidence.excludes_stiff};
}

/// Three digits that count, without an exponent: "0.52", "1350".
std::string kpa_text(double kpa) {
    const double unit = std::pow(10.0, std::floor(std::log10(kpa)) - 2);
    return kpa < 1000 ? fmt::format("{:.3g}", kpa)
                      : fmt::format("{:.0f}", std::round(kpa / unit) * unit);
}

/// What else there is to know of a modulus.
std::string further_text(const ModulusEvidence& evidence) {
    std::string others;
    for (const double kpa : evidence.other_kpa)
        others += (others.empty() ? "" : " and ") + kpa_text(kpa);
    if (!others.empty())
        others = fmt::format(
            "; there is more than one answer: searches that began elsewhere ended at {} kPa",
            others);
    if (std::abs(evidence.partner_correlation) <= strong_correlation) return others;
    return others +
           fmt::format(
               "; its modulus trades with that of {} (correlation {:.2f}): a combination of "
               "the two is known better than either",
               evidence.partner, evidence.partner_correlation);
}

Judgement judge_contradiction(const ModulusEvidence& evidence) {
    const Contradiction& found = *evidence.contradiction;
    const bool tells = case_of(general_evidence(evidence)) != EvidenceCase::unseen;
    return {tells ? Verdict::weak : Verdict::not_identifiable,
            fmt::format("the search ended at {} kPa, far {} than was assumed beforehand; with a "
                        "probability of {:.0f} % something else than stiffness has moved the "
                        "contours: look at the distances after the search, and if such tissue is "
                        "expected, widen what is assumed beforehand{}",
                        kpa_text(found.end_kpa), found.is_stiffer ? "stiffer" : "softer",
                        100 * found.probability, further_text(evidence))};
}

Judgement judge_unseen(const ModulusEvidence& evidence) {
    const double left = std::max(evidence.sd_ln, evidence.seen_sd_ln);
    const char* why = evidence.other_kpa.empty()
                          ? ": the organ does not deform enough relative to its surroundings"
                          : "";
    return {Verdict::not_identifiable,
            fmt::format("the images hardly narrow what was assumed beforehand (ln E {:.2f} "
                        "against {:.2f} before){}{}",
                        left, evidence.prior_sd_ln, why, further_text(evidence))};
}

Judgement judge_one_sided(const ModulusEvidence& evidence, EvidenceCase which) {
    if (which == EvidenceCase::lower_bound_only) {
        return {Verdict::weak,
                fmt::format("only a lower bound is known, {} kPa: anything stiffer moves "
                            "almost as a rigid body, and no image can tell how stiff; the upper "
                            "end comes from what was assumed beforehand{}",
                            kpa_text(evidence.interval_kpa[0]), further_text(evidence))};
    }
    return {Verdict::weak,
            fmt::format("only an upper bound is known, {} kPa: anything softer fits "
                        "as well; the lower end comes from what was assumed beforehand{}",
                        kpa_text(evidence.interval_kpa[1]), further_text(evidence))};
}

bool holds(const ModulusEvidence& evidence, double kpa) {
    return kpa >= evidence.interval_kpa[0] && kpa <= evidence.interval_kpa[1];
}

}  // namespace

ModulusEvidence evidence_with(const ModulusAnswer& found,
                              const std::vector<ModulusAnswer>& others) {
    ModulusEvidence evidence = found.evidence;
    auto& [low, high] = evidence.interval_kpa;
    for (const ModulusAnswer& answer : others) {
        const ModulusEvidence& other = answer.evidence;
        if (holds(found.evidence, answer.kpa) && holds(other, found.kpa)) continue;
        low = std::min(low, other.interval_kpa[0]);
        high = std::max(high, other.interval_kpa[1]);
        evidence.sd_ln = std::max(evidence.sd_ln, other.sd_ln);
        evidence.seen_sd_ln = std::max(evidence.seen_sd_ln, other.seen_sd_ln);
        evidence.excludes_soft = evidence.excludes_soft && other.excludes_soft;
        evidence.excludes_stiff = evidence.excludes_stiff && other.excludes_stiff;
        evidence.other_kpa.push_back(answer.end_kpa);
    }
    if (evidence.other_kpa.empty()) return evidence;
    std::sort(evidence.other_kpa.begin(), evidence.other_kpa.end());
    // As of one Gaussian of ln E with these for its 95 % interval
    const double sd_ln = std::min(evidence.prior_sd_ln, std::log(high / low) / (2 * 1.96));
    evidence.sd_ln = std::max(evidence.sd_ln, sd_ln);
    return evidence;
}

Judgement judge(const ModulusEvidence& evidence) {
    if (evidence.contradiction) return judge_contradiction(evidence);
    const EvidenceCase which = case_of(general_evidence(evidence));
    if (which == EvidenceCase::unseen) return judge_unseen(evidence);
    if (which != EvidenceCase::bounded) return judge_one_sided(evidence, which);
    const double span = evidence.interval_kpa[1] / evidence.interval_kpa[0];
    const Verdict verdict = verdict_of_span(span);
    const int digits = verdict == Verdict::weak ? 1 : 2;
    return {verdict, fmt::format("the 95 % interval spans a factor of {:.{}f}{}", span, digits,
                                 further_text(evidence))};
}

std::array<double, 2> told_interval(const ModulusEvidence& evidence, const Judgement& judgement,
                                    double median_kpa) {
    const std::array<double, 2> prior = prior_interval(median_kpa, evidence.prior_sd_ln);
    const std::array<double, 2>& found = evidence.interval_kpa;
    if (!evidence.contradiction)
        return told_interval(found, prior, general_evidence(evidence), judgement.verdict);
    if (judgement.verdict != Verdict::not_identifiable) return found;
    return {std::min(found[0], prior[0]), std::max(found[1], prior[1])};
}

std::array<double, 2> RatioEvidence::interval() const {
    return {std::max(allowed[0], best - reach[0]), std::min(allowed[1], best + reach[1])};
}

Judgement judge_ratio(const RatioEvidence& evidence) {
    const auto [down, up] = evidence.reach;
    const double width = evidence.at_limit == RatioLimit::lowest    ? 2 * up
                         : evidence.at_limit == RatioLimit::highest ? 2 * down
                                                                    : down + up;
    const double range = evidence.allowed[1] - evidence.allowed[0];
    const double share = width / (2 * 1.96 * range / std::sqrt(12.0));
    const std::string text = fmt::format(
        "the images leave {:.0f} % of the spread that was assumed beforehand, {:.3g} to "
        "{:.3g}",
        100 * std::min(share, 1.0), evidence.allowed[0], evidence.allowed[1]);
    const Verdict verdict = verdict_of_share(share);
    if (verdict != Verdict::not_identifiable && evidence.at_limit != RatioLimit::none) {
        return {Verdict::weak, text + "; the best ratio is an end of what was allowed"};
    }
    return {verdict, text};
}

Judgement judge_unobserved(bool surface_is_driven) {
    if (surface_is_driven) {
        return {Verdict::not_identifiable,
                "unknown forces act on the organ's whole surface, so any modulus fits; the prior "
                "median was used"};
    }
    return {Verdict::not_identifiable,
            "no free surface of the organ was seen in both images; the prior median was used"};
}

Judgement not_judged(const std::string& method) {
    return {Verdict::not_judged, fmt::format("the 95 % interval is not computed by {}", method)};
}

Judgement judge_without_reference() {
    return {Verdict::not_identifiable,
            "no tissue has a known modulus: with no measured force only ratios can be found; give "
            "one tissue or the background a stiffness_kpa"};
}

}  // namespace palpate
