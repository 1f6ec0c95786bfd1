// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace palpate {

/// What the data say of one quantity.
enum class Verdict : std::uint8_t {
    recovered,         ///< the data bound it narrowly, on both sides
    weak,              ///< they say something of it
    not_identifiable,  ///< they hardly narrow what was assumed beforehand
    not_judged,        ///< the search computes no interval
    given,             ///< it was no unknown
    hollow,            ///< it is of a region that is not modelled
};

/// The words of files and pages: "recovered", "weak", "not identifiable", "not judged", "given",
/// "hollow".
const char* name_of(Verdict verdict);
/// The verdict of such words. Throws Error(invalid_argument) naming the words that are allowed.
Verdict verdict_of(std::string_view words);

}  // namespace palpate
