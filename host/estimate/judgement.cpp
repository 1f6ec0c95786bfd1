// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/judgement.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

EvidenceCase case_of(const UnknownEvidence& evidence) {
    const double left = std::max(evidence.sd, evidence.seen_sd);
    if (left > evidence.prior_sd * unseen_share) return EvidenceCase::unseen;
    if (!evidence.excludes_low && !evidence.excludes_high) return EvidenceCase::unseen;
    if (!evidence.excludes_high) return EvidenceCase::lower_bound_only;
    return evidence.excludes_low ? EvidenceCase::bounded : EvidenceCase::upper_bound_only;
}

Verdict verdict_of_span(double span) {
    return span <= recovered_factor ? Verdict::recovered : Verdict::weak;
}

Verdict verdict_of_share(double share) {
    if (share > unseen_share) return Verdict::not_identifiable;
    return share <= recovered_share ? Verdict::recovered : Verdict::weak;
}

std::array<double, 2> prior_interval(double median, double prior_sd_ln) {
    const double spread = std::exp(1.96 * prior_sd_ln);
    return {median / spread, median * spread};
}

std::array<double, 2> told_interval(const std::array<double, 2>& found,
                                    const std::array<double, 2>& prior,
                                    const UnknownEvidence& evidence, Verdict verdict) {
    if (verdict == Verdict::not_identifiable) return prior;
    return {evidence.excludes_low ? found[0] : std::min(found[0], prior[0]),
            evidence.excludes_high ? found[1] : std::max(found[1], prior[1])};
}

}  // namespace palpate
