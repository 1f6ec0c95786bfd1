// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/recover/inverse/poisson_search.hpp"
#include "host/estimate/judgement.hpp"

namespace palpate {

/// Images that say what was hardly expected beforehand (with_misled_data).
struct Contradiction {
    double probability = 0;   ///< that something else than stiffness has moved the contours
    double end_kpa = 0;       ///< where the search has ended
    bool is_stiffer = false;  ///< than was assumed
};

/// What is known of one modulus after a search.
struct ModulusEvidence {
    std::array<double, 2> interval_kpa{1, 1};  ///< 95 %
    double sd_ln = 0, prior_sd_ln = 1;         ///< posterior and prior standard deviation of ln E
    double seen_sd_ln = 0;  ///< posterior one from the motion that is seen (posterior.hpp)
    bool excludes_soft = true, excludes_stiff = true;  ///< whether data without prior bound it
    /// If something else than stiffness may have moved the contours.
    std::optional<Contradiction> contradiction;
    std::vector<double> other_kpa;  ///< answers of searches that began elsewhere, ascending
    std::string partner;            ///< the organ whose modulus correlates most; may be empty
    double partner_correlation = 0;
};

/// What is known of a modulus where a search has ended.
struct ModulusAnswer {
    double kpa = 0;  ///< to be told
    ModulusEvidence evidence;
    double end_kpa = 0;         ///< where it has ended: the most probable modulus
    double believed_sd_ln = 0;  ///< of `kpa`, the other moduli being unknown (BelievedModuli)
};

/// What is known where searches that began elsewhere have ended too. Those of which one interval
/// does not hold the other's modulus tell another answer: the interval is widened to hold all
/// answers with all that each leaves open (method.md, 4.7), in whatever order they are given.
ModulusEvidence evidence_with(const ModulusAnswer& found, const std::vector<ModulusAnswer>& others);

/// A modulus is *recovered* if its 95 % interval spans at most a factor of 2 and the images bound
/// it on both sides and do not contradict what was assumed, *weak* if not, *not identifiable* if
/// the data, or the motion that they show, narrow the prior by less than a third (method.md section
/// 5).
Judgement judge(const ModulusEvidence& evidence);

/// The interval to tell of a modulus whose prior has this median: the prior's if it is not
/// identifiable, with what was found where the two contradict each other; else what was found,
/// where an end that the images do not give is at least the prior's.
std::array<double, 2> told_interval(const ModulusEvidence& evidence, const Judgement& judgement,
                                    double median_kpa);

/// What is known of one Poisson's ratio after a search.
struct RatioEvidence {
    double best = 0;
    std::array<double, 2> reach{0, 0};  ///< of the 95 % interval below and above it
    RatioLimit at_limit = RatioLimit::none;
    std::array<double, 2> allowed{0, 0.5};
    /// `best` and its reach, inside the allowed range.
    std::array<double, 2> interval() const;
};

/// A Poisson's ratio is *recovered* if its 95 % interval, the limits notwithstanding, is at most
/// half as wide as that of a ratio equally likely in the whole allowed range, *not identifiable* if
/// it is wider than two thirds, *weak* between, and at best weak at a limit.
Judgement judge_ratio(const RatioEvidence& evidence);

/// For a region that no observed surface touches: its modulus has no influence on the data.
Judgement judge_unobserved(bool surface_is_driven);

/// For a model whose every modulus is unknown: only ratios of moduli can be found.
Judgement judge_without_reference();

/// For a search that computes no interval.
Judgement not_judged(const std::string& method);

}  // namespace palpate
