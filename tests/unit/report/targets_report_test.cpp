// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/targets_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

using Names = std::vector<std::string>;

/// Commas outside quotes.
std::size_t separators(const std::string& csv) {
    std::size_t count = 0;
    bool is_quoted = false;
    for (const char c : csv) {
        if (c == '"') is_quoted = !is_quoted;
        if (c == ',' && !is_quoted) ++count;
    }
    return count;
}

TEST(TargetFolderNames, LeaveOutEveryEnding) {
    EXPECT_EQ(target_folder_names({"a/bladder.nii.gz", "day.2.nrrd", "c.mha", "plain"}),
              (Names{"bladder", "day.2", "c", "plain"}));
}

TEST(TargetFolderNames, AreDifferentAndNeverHidden) {
    EXPECT_EQ(target_folder_names({"a/t.nii", "b/t.nii.gz", "t-2.nii", ".nii", "targets.csv.nii"}),
              (Names{"t", "t-2", "t-2-2", "target", "targets.csv-2"}));
}

TEST(TargetFolderNames, CanBeNumbersThatTellNothing) {
    EXPECT_EQ(numbered_folder_names(2), (Names{"target-1", "target-2"}));
}

TEST(TargetsTable, ListsEveryUnknownRegionAndWhatWentWrong) {
    RecoveryResult cut_short = synthetic_result();
    cut_short.termination.converged = false;
    const std::vector<TargetRow> rows{target_row("one", synthetic_result(), 2.5),
                                      target_row("two", cut_short, 3),
                                      failed_row("three", "the solver broke down")};

    const std::string text = targets_table(rows);

    EXPECT_NE(text.find(name_of(rows[0].unknown[0].verdict)), std::string::npos) << text;
    EXPECT_NE(text.find("2.5\n"), std::string::npos) << text;
    EXPECT_NE(text.find("two: "), std::string::npos) << text;
    EXPECT_NE(text.find("failed"), std::string::npos) << text;
    EXPECT_NE(text.find("three: the solver broke down\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("one: "), std::string::npos) << text;
}

TEST(TargetsTable, ListsPoissonRatiosThatWereSearched) {
    RecoveryResult result = synthetic_result();
    result.regions[1].poisson_ratio = 0.42;
    result.regions[1].ratio = RatioResult{{0.38, 0.46}, Verdict::recovered, "narrow"};
    const std::vector<TargetRow> rows{target_row("one", result, 2.5), failed_row("two", "no")};

    const std::string table = targets_table(rows);

    EXPECT_NE(table.find("0.38 to 0.46"), std::string::npos) << table;
    EXPECT_NE(targets_csv(rows).find(",0.42,0.38,0.46,\"recovered\"\n"), std::string::npos);
    EXPECT_EQ(targets_table({target_row("one", synthetic_result(), 2.5)}).find("Poisson"),
              std::string::npos);
}

TEST(TargetsCsv, HasTheSameFieldsInEveryLine) {
    const std::vector<TargetRow> rows{target_row("one", synthetic_result(), 2.5),
                                      failed_row("a \"bad\" one", "no")};

    const std::string text = targets_csv(rows);

    const auto lines = 1 + rows[0].unknown.size() + 1;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), static_cast<std::ptrdiff_t>(lines));
    EXPECT_EQ(separators(text), 12 * lines);
    EXPECT_NE(text.find("\"a \"\"bad\"\" one\",\"\",,,,\"failed\",0,,\"no\",,,,\n"),
              std::string::npos)
        << text;
}

}  // namespace
}  // namespace palpate
