// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/result_tree.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/page/tree_json.hpp"
#include "tests/unit/page/two_springs.hpp"

namespace palpate {
namespace {

TEST(ResultTree, FiguresAreFoundByNamesAndPositions) {
    const ResultTree tree = two_springs();

    const Figure* left = find_figure(tree, "springs/left/stiffness_mn_per_mm");
    ASSERT_NE(left, nullptr);
    EXPECT_EQ(std::get<double>(left->value), 83.24);
    EXPECT_EQ(find_figure(tree, "springs/0/stiffness_mn_per_mm"), left);
    EXPECT_EQ(find_figure(tree, "springs/1/name"), find_figure(tree, "springs/right/name"));
    EXPECT_NE(find_figure(tree, "converged"), nullptr);
    for (const char* path : {"", "/", "springs", "springs/2/name", "springs/left/", "fit/0",
                             "springs/left/name/more", "nothing/name"})
        EXPECT_EQ(find_figure(tree, path), nullptr) << path;
}

TEST(ResultTree, ValuesAreShownAsPeopleReadThem) {
    const auto shown = [](FigureValue value, int digits = -1) {
        return shown_value(Figure{.name = "a", .value = std::move(value), .decimals = digits});
    };

    EXPECT_EQ(shown({}), "–");
    EXPECT_EQ(shown(std::nan("")), "–");
    EXPECT_EQ(shown(true), "yes");
    EXPECT_EQ(shown(std::int64_t{12345678}), "12345678");
    EXPECT_EQ(shown(0.0623456), "0.0623");
    EXPECT_EQ(shown(0.0623456, 1), "0.1");
    EXPECT_EQ(shown("words"), "words");
    EXPECT_EQ(shown(std::vector{1.0, std::nan("")}, 1), "(1.0, –)");
    EXPECT_EQ(shown(std::vector<std::string>{}), "()");
    EXPECT_EQ(shown(std::vector<std::vector<double>>{{1, 2}, {3, 4}}, 0), "((1, 2), (3, 4))");
}

TEST(ResultTree, AnIntervalIsShownWhereItIsOne) {
    Figure figure{.name = "a", .value = 2.0};
    EXPECT_EQ(shown_interval(figure, " to ", "-"), "-");
    figure.interval_95 = std::array{1.0, 3.0};
    EXPECT_EQ(shown_interval(figure, " to ", "-"), "1.00 to 3.00");
    figure.interval_95 = std::array{2.0, 2.0};
    EXPECT_EQ(shown_interval(figure, " to ", "-"), "-");
    figure.interval_95 = std::array{1.0, std::nan("")};
    EXPECT_EQ(shown_interval(figure, " to ", "-"), "1.00 to n/a");
}

TEST(TreeJson, KeepsTheOrderAndWritesWhatIsNotFiniteAsNull) {
    const auto json = nlohmann::ordered_json::parse(tree_json(two_springs()));

    std::vector<std::string> keys;
    for (const auto& item : json.items()) keys.push_back(item.key());
    EXPECT_EQ(keys, (std::vector<std::string>{"format", "converged", "springs", "fit"}));
    EXPECT_EQ(json["fit"].dump(),
              R"({"misfit_mm":0.126,"residuals_mm":[0.5,null,-1.0],)"
              R"("frame":[[1.0,0.0],[0.0,1.0]],"device":null,"points":[3,4],"nodes":7})");
}

TEST(TreeJson, AnEstimateIsAnObjectOrStandsBesideItsInterval) {
    ResultTree tree = two_springs();
    EXPECT_EQ(nlohmann::ordered_json::parse(tree_json(tree))["springs"][1].dump(),
              R"({"name":"right","stiffness_mn_per_mm":{"value":20.0,"unit":"mN/mm",)"
              R"("interval":[61.4,null],"verdict":"not identifiable",)"
              R"("reason":"the <interval> is what it is"}})");

    ResultTree beside;
    beside.add(Figure{.name = "stiffness_kpa",
                      .value = 5.0,
                      .interval_95 = std::array{4.0, 6.0},
                      .verdict = Verdict::weak,
                      .reason = "why",
                      .interval_name = "interval_kpa"});
    EXPECT_EQ(nlohmann::ordered_json::parse(tree_json(beside)).dump(),
              R"({"stiffness_kpa":5.0,"interval_kpa":[4.0,6.0],"verdict":"weak","reason":"why"})");
}

TEST(TreeJson, WhatIsForPeopleOnlyIsNotWritten) {
    ResultTree tree;
    tree.add(Figure{.value = "on host", .title = "Element loops"});
    EXPECT_EQ(nlohmann::json::parse(tree_json(tree)).dump(), "{}");
}

TEST(TreeJson, TextThatIsNotUtf8IsMended) {
    ResultTree tree;
    tree.add("name", "H\xf6hle");
    EXPECT_EQ(nlohmann::json::parse(tree_json(tree))["name"], "H\xef\xbf\xbdhle");
}

}  // namespace
}  // namespace palpate
