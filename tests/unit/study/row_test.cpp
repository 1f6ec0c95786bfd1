// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/row.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

TEST(Row, KeepsValuesAsTheFileHoldsThem) {
    Row row;
    row.set("true_kpa", 83.456, 1);
    row.set("error", NAN, 2);
    row.set_flag("converged", true);

    EXPECT_EQ(row.text("true_kpa"), "83.5");
    EXPECT_EQ(row.number("true_kpa"), 83.5);
    EXPECT_FALSE(row.has("error"));
    EXPECT_TRUE(std::isnan(row.number("error")));
    EXPECT_TRUE(row.flag("converged"));
    EXPECT_TRUE(std::isnan(row.number("missing")));
}

TEST(Csv, GivesBackTheRowsThatWereWritten) {
    Row first, second;
    first.set("case", "seed-1");
    first.set("text", "a \"word\", and\nmore");
    second.set("case", "seed-2");

    const auto rows = parse_csv(to_csv({"case", "text"}, {first, second}), "study.csv");

    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].text("text"), "a \"word\", and\nmore");
    EXPECT_EQ(rows[1].text("case"), "seed-2");
    EXPECT_FALSE(rows[1].has("text"));
}

TEST(Csv, OfNoRowsIsAHeader) {
    EXPECT_EQ(to_csv({"case", "seed"}, {}), "case,seed\n");
    EXPECT_TRUE(parse_csv("case,seed\n", "study.csv").empty());
}

TEST(Csv, NamesTheLineThatIsBroken) {
    try {
        parse_csv("case,seed\na,1\nb\n", "out/study.csv");
        FAIL() << "a short line was accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("out/study.csv has 1 values in line 3"),
                  std::string::npos)
            << error.what();
    }
}

}  // namespace
}  // namespace palpate
