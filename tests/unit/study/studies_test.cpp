// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/studies.hpp"

#include <gtest/gtest.h>

#include <set>

#include "host/apps/study/beside.hpp"
#include "host/apps/study/pelvis_case.hpp"

namespace palpate {
namespace {

class EveryStudy : public testing::TestWithParam<std::string> {
protected:
    Study make(int phantoms, unsigned first_seed = 1) const {
        StudyOptions options;
        options.phantoms = phantoms;
        options.first_seed = first_seed;
        for (const StudyEntry& entry : study_registry())
            if (entry.name == GetParam()) return entry.make(options);
        throw std::runtime_error("no such study");
    }
};

TEST_P(EveryStudy, HasCasesOfItsOwnNameThatStayWhenMoreAreAsked) {
    const Study few = make(2), many = make(3);

    std::set<std::string> ids;
    for (const StudyCase& work : many.cases) EXPECT_TRUE(ids.insert(work.id).second) << work.id;
    for (const StudyCase& work : few.cases) EXPECT_TRUE(ids.contains(work.id)) << work.id;
    EXPECT_EQ(few.name, GetParam());
    EXPECT_EQ(few.settings, many.settings);
    EXPECT_FALSE(few.title.empty());
    EXPECT_EQ(std::set<std::string>(few.columns.begin(), few.columns.end()).size(),
              few.columns.size());
}

/// Made-up values for all columns: the page of any study must hold for any numbers and verdict.
TEST_P(EveryStudy, ReportsOneRowAndRowsWithoutNumbers) {
    const Study study = make(1);
    Row numbers, nothing;
    for (const std::string& column : study.columns)
        if (column.ends_with("verdict"))
            numbers.set(column, std::string("weak"));
        else
            numbers.set(column, 50, 1);

    for (const auto& rows : {std::vector{numbers}, std::vector{numbers, nothing}}) {
        const StudyReport report = study.report(rows);

        EXPECT_FALSE(report.headline.empty());
        EXPECT_FALSE(report.sections.empty());
        EXPECT_FALSE(report.text.empty());
        for (const StudySection& section : report.sections)
            for (const StudyPicture& picture : section.pictures)
                EXPECT_EQ(picture.svg.find("nan"), std::string::npos) << picture.svg;
    }
}

std::vector<std::string> study_names() {
    std::vector<std::string> names;
    for (const StudyEntry& entry : study_registry()) names.push_back(entry.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(Studies, EveryStudy, testing::ValuesIn(study_names()),
                         [](const auto& entry) {
                             std::string name = entry.param;
                             std::erase(name, '-');
                             return name;
                         });

TEST(DrawnStiffness, IsSpreadOverTheRangeAndTheSameForASeed) {
    int num_soft = 0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
        const double drawn = drawn_stiffness_kpa(seed);
        EXPECT_EQ(drawn, drawn_stiffness_kpa(seed));
        EXPECT_GE(drawn, 40);
        EXPECT_LE(drawn, 350);
        num_soft += drawn < std::sqrt(40.0 * 350.0);
    }
    EXPECT_NEAR(num_soft, 100, 25);
}

TEST(LandmarkErrors, VanishForAFieldThatIsTheTruth) {
    ImageGrid grid;
    grid.size = {4, 5, 6};
    grid.origin = Vec3(10, -5, 3);
    grid.spacing = Vec3(1, 2, 3);
    const auto truth = [](const Vec3& x) { return Vec3(0.1 * x[1], 1 + x[0], -0.2 * x[2]); };
    Image<Vec3> field{grid, std::vector<Vec3>(grid.num_voxels())};
    for (Index k = 0; k < 6; ++k)
        for (Index j = 0; j < 5; ++j)
            for (Index i = 0; i < 4; ++i) field.at(i, j, k) = truth(grid.to_point(Vec3(i, j, k)));
    PelvisPhantom phantom;
    phantom.landmarks = {Vec3(11.3, -2.2, 7.7), Vec3(13, 3, 18)};
    phantom.landmark_displacements = {truth(phantom.landmarks[0]),
                                      truth(phantom.landmarks[1]) + Vec3(3, 0, 4)};

    const auto errors = landmark_errors_mm(phantom, field);

    EXPECT_NEAR(errors[0], 0, 1e-12);
    EXPECT_NEAR(errors[1], 5, 1e-12);
}

TEST(BesideTable, SortsLinesByKeyAndKeepsColumnsInOrder) {
    BesideTable table("E");
    table.add(100, "ours", "a");
    table.add(50, "published", "b");

    EXPECT_EQ(table.table().header, (std::vector<std::string>{"E", "ours", "published"}));
    EXPECT_EQ(table.table().lines[0], (std::vector<std::string>{"50", "–", "b"}));
    EXPECT_EQ(table.table().lines[1], (std::vector<std::string>{"100", "a", "–"}));
}

}  // namespace
}  // namespace palpate
