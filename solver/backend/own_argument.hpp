// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/model/refuse.hpp"

namespace palpate {

[[noreturn]] inline void refuse_foreign_argument() {
    refuse(
        "An argument belongs to another back end, precision or model: make it with the back end "
        "that uses it.");
}

/// A vector, sums or operator as the type that the back end which uses it makes. Throws
/// Error(invalid_argument) if another back end made it.
template <class Own, class Argument>
Own& own(Argument& argument) {
    if (auto* found = dynamic_cast<Own*>(&argument)) return *found;
    refuse_foreign_argument();
}

}  // namespace palpate
