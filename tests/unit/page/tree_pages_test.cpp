// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/page/figure_html.hpp"
#include "host/page/tree_html.hpp"
#include "host/page/tree_table.hpp"
#include "host/page/tree_text.hpp"
#include "tests/unit/page/two_springs.hpp"

namespace palpate {
namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(TreeText, TellsWhatHasATitle) {
    EXPECT_EQ(tree_text(two_springs()),
              "Converged: yes\n"
              "\n"
              "Springs\n"
              "Spring  Stiffness mN/mm  95 % interval  Verdict\n"
              "------  ---------------  -------------  ----------------\n"
              "left               83.2    61.4 to 113  recovered\n"
              "right                 –    61.4 to n/a  not identifiable\n"
              "\n"
              "Fit\n"
              "Misfit: 0.13 mm\n");
}

TEST(TreeText, AnEstimateOutsideAListIsALineAndCannotMisleadATerminal) {
    ResultTree tree;
    tree.add(Figure{.name = "k",
                    .value = 2.0,
                    .unit = "kPa",
                    .title = "Stiff\x1b[2Jness",
                    .interval_95 = std::array{1.0, 3.0},
                    .verdict = Verdict::weak,
                    .reason = "wide"});
    EXPECT_EQ(tree_text(tree),
              "Stiff?[2Jness: 2.00 kPa (95 % interval 1.00 to 3.00). Verdict: weak: wide\n");
}

TEST(TreeTable, ShowsTheFiguresThatAreAskedForAndLeavesOutEmptyColumnsAndLines) {
    ResultTree list{.shape = ResultTree::Shape::list};
    for (const char* name : {"one", "two", "three"}) {
        ResultTree& part = list.add_part(name);
        part.add(Figure{.name = "name", .value = name, .title = "Name"});
        part.add(Figure{.name = "never", .title = "Never"});
        part.add(Figure{.name = "size",
                        .value = name == std::string("two") ? FigureValue{} : FigureValue{2.5},
                        .title = "Size"});
    }

    const TreeTable table = table_of(list, {"name", "never", "size"});

    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_EQ(table.columns[1].title, "Size");
    ASSERT_EQ(table.lines.size(), 2u);
    EXPECT_EQ(table.lines[1], (std::vector<std::string>{"three", "2.50"}));
    EXPECT_EQ(table.parts[1]->name, "three");
}

TEST(TreeHtml, HoldsCardsFactsAndTables) {
    ResultTree tree = two_springs();
    tree.add(Figure{.name = "k",
                    .value = 2.0,
                    .unit = "kPa",
                    .title = "Both",
                    .interval_95 = std::array{1.0, 3.0},
                    .verdict = Verdict::weak});

    const std::string html = tree_html(tree);

    EXPECT_TRUE(has(html, "<dt>Converged</dt><dd>yes</dd>"));
    EXPECT_TRUE(has(html, "<p class='value'>2.00 <small>kPa</small></p>"));
    EXPECT_TRUE(has(html, "<p>95 % interval 1.00 – 3.00 kPa</p>"));
    EXPECT_TRUE(has(html, "<section><h2>Springs</h2><div class='scroll'><table>"));
    EXPECT_TRUE(has(html, "<td class='num'>83.2</td>"));
    EXPECT_TRUE(has(html, "<span class='chip bad'>not identifiable</span>"));
    EXPECT_TRUE(has(html, "<dt>Misfit</dt><dd>0.13 mm</dd>"));
    EXPECT_FALSE(has(html, "residuals"));
}

TEST(TreeHtml, EscapesEveryText) {
    const std::string evil = "<b class=\"evil\">&";
    ResultTree tree;
    tree.add(Figure{.name = evil,
                    .value = 1.0,
                    .unit = evil,
                    .title = evil,
                    .interval_95 = std::array{0.5, 2.0},
                    .verdict = Verdict::weak,
                    .reason = evil});
    tree.add(Figure{.name = evil, .value = evil, .unit = evil, .title = evil});
    ResultTree& list = tree.add_part("list", ResultTree::Shape::list);
    list.title = evil;
    list.add_part(evil).add(
        Figure{.name = evil, .value = evil, .unit = evil, .title = evil, .meaning = evil});

    const std::string html = tree_html(tree);

    EXPECT_FALSE(has(html, "<b class"));
    EXPECT_TRUE(has(html, "&lt;b class="));
}

TEST(TitledRows, AreOfWhatIsNoEstimateAndInNoList) {
    ResultTree tree = two_springs();
    tree.add_part("deeper").add(Figure{.value = "on host", .title = "Element loops"});

    EXPECT_EQ(titled_rows(tree),
              (std::vector<std::pair<std::string, std::string>>{
                  {"Converged", "yes"}, {"Misfit", "0.13 mm"}, {"Element loops", "on host"}}));
}

TEST(EstimateCard, ShowsNoValueOfWhatIsNotIdentifiable) {
    const std::string card = estimate_card(
        {.name = "k", .value = 5.0, .verdict = Verdict::not_identifiable}, "k", "red");

    EXPECT_TRUE(has(card, "<p class='value'>–</p>"));
    EXPECT_FALSE(has(card, "5.00"));
    EXPECT_TRUE(has(card, "chip bad"));
}

}  // namespace
}  // namespace palpate
