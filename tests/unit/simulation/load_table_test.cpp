// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/load_table.hpp"

#include <gtest/gtest.h>

#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

LoadTable history(const std::string& keys) {
    return read_history(*SettingsTable::parse("[history]\n" + keys, "m.toml").table("history"),
                        ".");
}

void expect_csv_refused(const std::string& text, const std::vector<std::string>& words) {
    expect_refused([&] { parse_load_csv(text, "loads.csv"); }, words, ErrorCode::input_unreadable);
}

TEST(LoadTable, IsReadFromCommaSeparatedValues) {
    const LoadTable table =
        parse_load_csv("# a ramp\ntime_s, pull ,push\r\n0,0,0\n\n0.5, 1e-1,+2\n1,1,-3\n", "f.csv");

    EXPECT_EQ(table.columns, (std::vector<std::string>{"pull", "push"}));
    EXPECT_EQ(table.time_s, (std::vector<double>{0.5, 1}));
    EXPECT_EQ(table.factors, (std::vector<std::vector<double>>{{0.1, 2}, {1, -3}}));
}

TEST(LoadTable, MistakesInAFileAreNamedWithTheirLine) {
    expect_csv_refused("t,pull\n1,1\n", {"loads.csv, line 1", "'time_s'", "'t'"});
    expect_csv_refused("time_s,pull\n1,abc\n", {"line 2", "'abc'"});
    expect_csv_refused("time_s,pull\n1,1\n2\n", {"line 3", "1 values for 2"});
    expect_csv_refused("time_s,pull\n1,1\n1,2\n", {"line 3", "ascend"});
    expect_csv_refused("time_s,pull\n0,1\n1,2\n", {"line 2", "at rest"});
    expect_csv_refused("time_s,pull,pull\n1,1,2\n", {"line 1", "'pull'", "twice"});
    expect_csv_refused("time_s,pull\n1,nan\n", {"line 2", "'nan'"});
    expect_csv_refused("time_s,pull\n", {"no row"});
}

TEST(LoadTable, RowsArePutBetweenSoThatNoStepIsLonger) {
    const LoadTable table = history("time_s = [1, 2]\npull = [1, 3]\nlongest_step_s = 0.5\n");

    ASSERT_EQ(table.time_s, (std::vector<double>{0.5, 1, 1.5, 2}));
    EXPECT_EQ(table.factors, (std::vector<std::vector<double>>{{0.5}, {1}, {2}, {3}}));
}

TEST(LoadTable, StepsThatAreShortEnoughStayAsTheyAre) {
    EXPECT_EQ(history("time_s = [0.1, 0.2, 0.3]\nlongest_step_s = 0.1\n").time_s,
              (std::vector<double>{0.1, 0.2, 0.3}));
    expect_refused([] { history("time_s = [1]\nlongest_step_s = 1e-9\n"); }, {"longest_step_s"});
}

TEST(LoadTable, AFileTakesNoOtherColumns) {
    expect_refused([] { history("file = \"a.csv\"\npull = [1]\n"); }, {"'pull'", "file"});
    expect_refused([] { history("file = \"nowhere.csv\"\n"); }, {"nowhere.csv", "no such file"});
}

}  // namespace
}  // namespace palpate
