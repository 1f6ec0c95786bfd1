// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/recover/result/recovery_result.hpp"
#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

/// An organ on a card: mm LPS, all in the frame of the reference.
struct CardOrgan {
    std::string colour;  ///< as CSS
    Surface reference, moved, target;
};

inline constexpr const char* case_card_name = "card.svg";

/// Three slices of one scale through `at`, axial, coronal and sagittal, laid out as those of a
/// report: the reference as an area, the target as a broad line, the moved reference as a fine one
/// in the organ's colour. Outlines only, never grey values. Some 5 kB of SVG that needs nothing
/// else.
std::string card_svg(const std::vector<CardOrgan>& organs, const Vec3& at);

/// The card of a result, through the middle of the organs whose modulus was unknown. Needs surfaces
/// and motion, no volumes.
std::string case_card(const RecoveryResult& result);

}  // namespace palpate
