// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/case_card.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "host/apps/recover/result/recovery_result.hpp"
#include "host/cohort/case_flags.hpp"

namespace palpate {
namespace {

/// An octahedron of radius `r` mm.
Surface octahedron(const Vec3& centre, double r) {
    Surface s;
    for (int a = 0; a < 3; ++a)
        for (const double sign : {1.0, -1.0})
            s.vertices.push_back(centre + sign * r * Vec3::Unit(a));
    for (const Index x : {0, 1})
        for (const Index y : {2, 3})
            for (const Index z : {4, 5}) s.triangles.push_back({x, y, z});
    return s;
}

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size())
        ++count;
    return count;
}

TEST(CaseCard, ShowsThreeSlicesOfEachOrgan) {
    const CardOrgan organ{"#123456", octahedron({0, 0, 0}, 10), octahedron({2, 0, 0}, 10),
                          octahedron({2, 1, 0}, 10)};
    const std::string card = card_svg({organ, organ}, {1, 0.3, 0.2});
    EXPECT_EQ(count_of(card, "class='r'"), 6u);
    EXPECT_EQ(count_of(card, "class='t'"), 6u);
    EXPECT_EQ(count_of(card, "class='m'"), 6u);
    EXPECT_EQ(count_of(card, "z'/>"), 18u);  // closed
    EXPECT_LT(card.size(), 5000u);
    EXPECT_TRUE(card.starts_with("<svg xmlns=") && card.ends_with("</svg>\n"));
    EXPECT_EQ(card_svg({}, {0, 0, 0}), "");
}

TEST(CaseCard, LeavesOutWhatASliceDoesNotMeet) {
    const CardOrgan organ{"red", octahedron({0, 0, 0}, 10), octahedron({0, 0, 0}, 10), {}};
    const std::string card = card_svg({organ}, {0.1, 0.2, 40});
    EXPECT_EQ(count_of(card, "class='m'"), 2u);
    EXPECT_EQ(count_of(card, "class='t'"), 0u);
}

TEST(CaseFlags, HaveNamesThatLeadBack) {
    std::set<std::string> names;
    for (std::size_t k = 0; k < num_case_flags; ++k) {
        const auto flag = static_cast<CaseFlag>(k);
        EXPECT_TRUE(names.insert(name_of(flag)).second);
        EXPECT_EQ(case_flag_of(name_of(flag)), flag);
    }
    EXPECT_FALSE(case_flag_of("fine"));
}

TEST(CaseFlags, AreWorseTheGraverTheyAre) {
    CaseFlags weak, folded, failed;
    weak.add(CaseFlag::weak);
    folded.add(CaseFlag::folded);
    failed.add(CaseFlag::failed);
    EXPECT_GT(badness(folded), badness(weak));
    EXPECT_GT(badness(weak), badness({}));
    EXPECT_LT(badness(failed), badness({}));  // there is no picture of it
}

TEST(CaseFlags, SayThatImagesContradictWhatWasExpected) {
    RecoveryResult result;
    result.displacement_field.grid.spacing = {1, 1, 1};
    result.termination.converged = true;
    result.regions.resize(1);
    result.regions[0].unknown = true;
    result.regions[0].verdict = Verdict::weak;
    EXPECT_FALSE(flags_of_result(result).has(CaseFlag::contradicts_prior));
    result.regions[0].contradicts_prior = true;
    EXPECT_TRUE(flags_of_result(result).has(CaseFlag::contradicts_prior));
}

TEST(CaseFlags, FindTheOneUnlikeTheOthers) {
    const std::vector<bool> found = unlike_the_others({4.0, 4.1, 3.9, 4.05, 5.0, 3.95});
    EXPECT_EQ(found, (std::vector<bool>{false, false, false, false, true, false}));
    EXPECT_EQ(unlike_the_others({4, 4, 4, 4, 4.1}), std::vector<bool>(5, false));  // narrow
    EXPECT_EQ(unlike_the_others({1, 9, 1}), std::vector<bool>(3, false));
}

}  // namespace
}  // namespace palpate
