// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/moved_grid.hpp"

#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include "solver/base/error.hpp"
#include "tests/unit/report/temporary_folder.hpp"
#include "tests/unit/warping/oblique_scene.hpp"

namespace palpate {
namespace {

using namespace testing;
using MovedGridFile = TemporaryFolderTest;

TEST(MovedGrid, FollowsTheMapAlongEveryAxis) {
    const PointMap map{sampled(oblique_grid({12, 11, 10}), smooth_displacement)};

    const MovedGrid grid = moved_grid(map, map.field.grid, 1000);  // the edges of the box only

    EXPECT_EQ(grid.lines.size(), 12u);
    EXPECT_EQ(grid.points.size(), 4u * (12 + 11 + 10));
    for (std::size_t n = 0; n < grid.points.size(); ++n) {
        const Vec3 x = grid.points[n].point - grid.displacement[n];
        EXPECT_LT((grid.displacement[n] - displacement_at(map.field, x)).norm(), 1e-9);
    }
}

TEST(MovedGrid, RefusesADistanceOfNothing) {
    const PointMap map{sampled(oblique_grid({4, 4, 4}), smooth_displacement)};

    EXPECT_THROW(moved_grid(map, map.field.grid, 0), Error);
}

TEST_F(MovedGridFile, IsReadByVtkWithItsFrame) {
    const PointMap map{sampled(oblique_grid({12, 11, 10}), smooth_displacement)};
    const MovedGrid grid = moved_grid(map, map.field.grid, 6);
    write_moved_grid(folder / "grid.vtp", grid);

    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName((folder / "grid.vtp").c_str());
    reader->Update();

    vtkPolyData* data = reader->GetOutput();
    ASSERT_EQ(data->GetNumberOfPoints(), vtkIdType(grid.points.size()));
    EXPECT_EQ(data->GetNumberOfLines(), vtkIdType(grid.lines.size()));
    EXPECT_LT((Vec3(data->GetPoint(77)) - grid.points[77].point).norm(), 1e-9);
    EXPECT_NE(data->GetPointData()->GetArray("displacement"), nullptr);
    auto* space = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("SPACE"));
    ASSERT_NE(space, nullptr);
    EXPECT_EQ(space->GetValue(0), "LPS");
}

}  // namespace
}  // namespace palpate
