// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/point_table.hpp"

#include <gtest/gtest.h>

#include "solver/base/error.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

class Points : public TemporaryFolderTest {
protected:
    PointTable table_of(const std::string& text, PointAxes axes = PointAxes::lps) {
        std::ofstream(folder / "points.csv", std::ios::binary) << text;
        return read_points(folder / "points.csv", axes);
    }
    /// The message with which the text is refused.
    std::string refusal(const std::string& text) {
        try {
            table_of(text);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input_unusable);
            return error.what();
        }
        return "no error";
    }
};

std::vector<MovedPoint> moved(const PointTable& table, const Vec3& by) {
    std::vector<MovedPoint> points;
    for (const Vec3& p : table.points) points.push_back({p + by, true});
    return points;
}

TEST_F(Points, KeepOtherColumnsAndTheirOrder) {
    const PointTable table = table_of("name,Z_mm,x,Y,note\n\"a, b\",3,1,2,hello\nc,6,4,5,\n");
    auto points = moved(table, Vec3(10, 20, 30));
    points[1].inside = false;

    EXPECT_EQ(points_csv(table, points, PointAxes::lps),
              "name,Z_mm,x,Y,note,inside\n"
              "\"a, b\",33.000000,11.000000,22.000000,hello,1\n"
              "c,36.000000,14.000000,25.000000,,0\n");
}

TEST_F(Points, NeedNoHeaderAndMayHaveWindowsLineEndsAndComments) {
    const PointTable table = table_of("# from somewhere\r\n1,2,3\r\n\r\n-4.5e1, +5 ,6,x\r\n");

    EXPECT_EQ(table.points, (std::vector<Vec3>{Vec3(1, 2, 3), Vec3(-45, 5, 6)}));
    EXPECT_EQ(points_csv(table, moved(table, Vec3::Zero()), PointAxes::lps),
              "# from somewhere\n1.000000,2.000000,3.000000,1\n-45.000000,5.000000,6.000000,x,1\n");
}

TEST_F(Points, InRasAreTurnedAndTurnedBack) {
    const PointTable table = table_of("1,2,3\n", PointAxes::ras);

    EXPECT_EQ(table.points.front(), Vec3(-1, -2, 3));
    EXPECT_EQ(points_csv(table, moved(table, Vec3(10, 0, 0)), PointAxes::ras),
              "-9.000000,2.000000,3.000000,1\n");
}

TEST_F(Points, ThatWereOutsideOnceStayMarked) {
    const PointTable table = table_of("x,y,z,inside\n1,2,3,0\n4,5,6,1\n");

    EXPECT_EQ(points_csv(table, moved(table, Vec3::Zero()), PointAxes::lps),
              "x,y,z,inside\n1.000000,2.000000,3.000000,0\n4.000000,5.000000,6.000000,1\n");
}

TEST_F(Points, ThatCannotBeReadAreNamed) {
    EXPECT_NE(refusal("x,y,z\n1,2,3\n1,2\n").find("line 3"), std::string::npos);
    EXPECT_NE(refusal("1,2,nan\n").find("column 3"), std::string::npos);
    EXPECT_NE(refusal("x,y,depth\n1,2,3\n").find("no column z"), std::string::npos);
    EXPECT_NE(refusal("x,y,z\n").find("no point"), std::string::npos);
    EXPECT_THROW(read_points(folder / "absent.csv", PointAxes::lps), Error);
}

}  // namespace
}  // namespace palpate
