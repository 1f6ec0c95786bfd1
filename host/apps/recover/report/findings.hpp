// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/recover/result/recovery_result.hpp"
#include "host/page/numbers.hpp"

namespace palpate {

/// The name of a region of the result; "region N" if it has none.
std::string region_name(const RecoveryResult& result, Index region);
/// The colour of a region in every picture, "#rrggbb", told apart by colour-blind readers; fixed
/// organs are grey.
std::string region_colour(const RecoveryResult& result, Index region);
/// Whether there is a modulus to tell, given or found.
bool is_known(const RegionResult& region);
/// Sum of the stages.
double total_seconds(const RecoveryResult& result);
/// How the known tissue is called to which an unknown modulus is compared; null if there is none.
const RegionResult* reference_tissue(const RecoveryResult& result);

/// "at least 274 kPa (the upper end, 2,620 kPa, is what was assumed beforehand)" where the images
/// give one end of a modulus' interval only; empty where they give both, or neither.
std::string bound_text(const RegionResult& region);
/// What was found about one unknown modulus, in one or two sentences.
std::string finding_sentence(const RecoveryResult& result, const RegionResult& region);
/// What was found about one Poisson's ratio that was searched.
std::string ratio_sentence(const RegionResult& region);
/// How well the surfaces agree, in one sentence; empty without observed surfaces.
std::string surfaces_sentence(const RecoveryResult& result);
/// "12 landmarks: mean error 3.1 mm after rigid alignment, 0.8 mm after the recovery, largest 1.9
/// mm.", or nothing without landmarks.
std::string landmark_sentence(const RecoveryResult& result);
/// How much of each organ's surface carried data; empty where the target has labels.
std::string seen_sentence(const RecoveryResult& result);
/// How far the contours are off, in one sentence; empty where the search looked for nothing.
std::string contours_sentence(const RecoveryResult& result);
/// Whether the search converged, in one sentence.
std::string termination_sentence(const RecoveryResult& result);
/// The law that all tissue was taken to obey, one sentence.
std::string law_sentence(const RecoveryResult& result);
/// Which linear solver each stage used, where and why, in one line; empty if nobody says.
std::string linear_solvers_text(const RecoveryResult& result);
/// What was found, how well the surfaces agree and whether the search converged, in that order.
std::vector<std::string> summary_sentences(const RecoveryResult& result);

}  // namespace palpate
