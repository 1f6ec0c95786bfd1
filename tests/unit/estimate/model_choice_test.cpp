// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/model_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::size_t preferred(const std::vector<ModelCandidate>& candidates) {
    return preferred_model(candidates);
}

TEST(ModelChoice, AnotherNumberHasToBeWorthMoreThanABareMention) {
    EXPECT_EQ(preferred({{-7, 3}}), 0u);
    EXPECT_EQ(preferred({{100, 4}, {100.9, 6}}), 0u);
    EXPECT_EQ(preferred({{100, 4}, {101.1, 6}}), 1u);
    EXPECT_EQ(preferred({{101.1, 6}, {100, 4}}), 0u);
}

TEST(ModelChoice, TheLeadIsThatOverTheHighestNotOverTheNext) {
    // each is within a bare mention of the next, the simplest not of the best
    EXPECT_EQ(preferred({{100, 2}, {100.7, 4}, {101.4, 6}}), 1u);
}

TEST(ModelChoice, OfAsManyNumbersTheEvidenceDecides) {
    EXPECT_EQ(preferred({{100.2, 4}, {100.6, 4}, {100.9, 6}}), 1u);
    EXPECT_EQ(preferred({{100.6, 4}, {100.2, 4}, {100.9, 6}}), 0u);
}

TEST(ModelChoice, EvidenceThatIsNoNumberIsTheLowest) {
    EXPECT_EQ(preferred({{std::nan(""), 1}, {-1000, 9}}), 1u);
    EXPECT_EQ(preferred({{HUGE_VAL, 1}, {-1000, 9}}), 1u);
    EXPECT_EQ(preferred({{std::nan(""), 3}, {std::nan(""), 2}}), 0u);
    EXPECT_THROW(preferred({}), Error);
}

}  // namespace
}  // namespace palpate
