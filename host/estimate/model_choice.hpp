// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace palpate {

/// A lead in ln evidence that is "not worth more than a bare mention" (Kass and Raftery 1995, 2 ln
/// B below 2).
inline constexpr double bare_mention = 1;

/// A model that was fitted to the same data as others.
struct ModelCandidate {
    double log_evidence = 0;
    int num_parameter = 0;
};

/// The place of the one to be taken: of all less than a bare mention below the highest evidence the
/// one with the fewest numbers, and of these the one with the highest evidence. Evidence that is
/// not a finite number is the lowest. Throws Error(invalid_argument) where there is no model.
std::size_t preferred_model(std::span<const ModelCandidate> candidates);

}  // namespace palpate
