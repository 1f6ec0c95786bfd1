// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/export/engineering_units.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(EngineeringUnits, AreConsistent) {
    // A bar of 2 mm x 3 mm and 60 kPa, stretched by 5 %: force = E A strain in both sets of units.
    constexpr double area_mm2 = 6, strain = 0.05, stiffness_kpa = 60;
    constexpr double force_mn = stiffness_kpa * area_mm2 * strain;

    EXPECT_DOUBLE_EQ(mpa_from_kpa(stiffness_kpa) * area_mm2 * strain, newton_from_mn(force_mn));
    EXPECT_DOUBLE_EQ(mpa_from_kpa(1000), 1);
    EXPECT_DOUBLE_EQ(newton_from_mn(1000), 1);
}

}  // namespace
}  // namespace palpate
