// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/identifiability.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

constexpr double strong_correlation = 0.9;

std::string trade_text(const ModulusEvidence& evidence) {
    if (std::abs(evidence.partner_correlation) <= strong_correlation) return "";
    return fmt::format(
        "; its modulus trades with that of {} (correlation {:.2f}): a combination of "
        "the two is known better than either",
        evidence.partner, evidence.partner_correlation);
}

Verdict judge_unseen(const ModulusEvidence& evidence) {
    const double left = std::max(evidence.sd_ln, evidence.seen_sd_ln);
    return {"not identifiable",
            fmt::format("the images hardly narrow what was assumed beforehand (ln E {:.2f} "
                        "against {:.2f} before): the organ does not deform enough relative to "
                        "its surroundings{}",
                        left, evidence.prior_sd_ln, trade_text(evidence))};
}

Verdict judge_one_sided(const ModulusEvidence& evidence) {
    if (!evidence.excludes_stiff && !evidence.excludes_soft) return judge_unseen(evidence);
    if (!evidence.excludes_stiff) {
        return {"weak",
                fmt::format("only a lower bound is known, {:.3g} kPa: anything stiffer moves "
                            "almost as a rigid body, and no image can tell how stiff; the upper "
                            "end comes from what was assumed beforehand{}",
                            evidence.interval_kpa[0], trade_text(evidence))};
    }
    return {"weak", fmt::format("only an upper bound is known, {:.3g} kPa: anything softer fits "
                                "as well; the lower end comes from what was assumed beforehand{}",
                                evidence.interval_kpa[1], trade_text(evidence))};
}

}  // namespace

Verdict judge(const ModulusEvidence& evidence) {
    const double span = evidence.interval_kpa[1] / evidence.interval_kpa[0];
    const double left = std::max(evidence.sd_ln, evidence.seen_sd_ln);
    if (left > evidence.prior_sd_ln * 2.0 / 3.0) return judge_unseen(evidence);
    if (!evidence.excludes_stiff || !evidence.excludes_soft) return judge_one_sided(evidence);
    const std::string trade = trade_text(evidence);
    if (span > 2.0) {
        return {"weak", fmt::format("the 95 % interval spans a factor of {:.1f}{}", span, trade)};
    }
    return {"recovered", fmt::format("the 95 % interval spans a factor of {:.2f}{}", span, trade)};
}

std::array<double, 2> with_prior_ends(const std::array<double, 2>& interval_kpa, double median_kpa,
                                      double prior_sd_ln) {
    const double spread = std::exp(1.96 * prior_sd_ln);
    return {std::min(interval_kpa[0], median_kpa / spread),
            std::max(interval_kpa[1], median_kpa * spread)};
}

Verdict judge_ratio(const std::array<double, 2>& interval, const std::array<double, 2>& allowed) {
    const double share = (interval[1] - interval[0]) / (allowed[1] - allowed[0]);
    const std::string verdict = share <= 1.0 / 3.0   ? "recovered"
                                : share <= 2.0 / 3.0 ? "weak"
                                                     : "not identifiable";
    return {verdict, fmt::format("the 95 % interval takes {:.0f} % of the range that was allowed, "
                                 "{:.3g} to {:.3g}",
                                 100 * share, allowed[0], allowed[1])};
}

Verdict judge_unobserved(bool surface_is_driven) {
    if (surface_is_driven) {
        return {"not identifiable",
                "unknown forces act on the organ's whole surface, so any modulus fits; the prior "
                "median is shown"};
    }
    return {"not identifiable",
            "no free surface of the organ was seen in both images; the prior median is shown"};
}

Verdict not_judged(const std::string& method) {
    return {"not judged", fmt::format("the 95 % interval is not computed by {}", method)};
}

Verdict judge_without_reference() {
    return {"not identifiable",
            "no tissue has a known modulus: with no measured force only ratios can be found; give "
            "one tissue or the background a stiffness_kpa"};
}

}  // namespace palpate
