// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/read_shapes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class ReadShapes : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / ("palpate_read_shapes_" + std::to_string(::getpid()));
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }

    fs::path file(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
        return folder / name;
    }
    template <typename Read>
    static void expect_error(ErrorCode code, const std::string& words, const Read& read) {
        try {
            read();
            FAIL() << "taken: " << words;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    }
    fs::path folder;
};

std::string rows(int count, const std::string& separator) {
    std::string text;
    for (int k = 0; k < count; ++k) {
        text += std::to_string(k) + separator + "-2.5" + separator + "1e1\n";
    }
    return text;
}

/// A pyramid of one square and four triangles.
vtkNew<vtkPolyData> pyramid() {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(0, 2, 0), Vec3(1, 1, 3),
                          Vec3(1, 1, 3)}) {
        points->InsertNextPoint(x.data());
    }
    vtkNew<vtkCellArray> faces;
    faces->InsertNextCell({3, 2, 1, 0});
    faces->InsertNextCell({0, 1, 4});
    faces->InsertNextCell({1, 2, 4});
    faces->InsertNextCell({2, 3, 5});  // the tip twice in the file
    faces->InsertNextCell({3, 0, 5});
    faces->InsertNextCell({0, 1, 1});  // no area
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(faces);
    return data;
}

TEST_F(ReadShapes, TakeCommasSemicolonsBlanksHeadersAndComments) {
    for (const std::string separator : {",", ";", " ", "\t", " , "}) {
        for (const std::string head : {"", "x_mm,y_mm,z_mm\n", "# cloud\n\nx y z\r\n"}) {
            const auto points = read_points(file("a.csv", head + rows(9, separator)));
            ASSERT_EQ(points.size(), 9u) << separator << head;
            EXPECT_EQ(points[3], Vec3(3, -2.5, 10));
        }
    }
    EXPECT_EQ(read_points(file("A.TXT", rows(8, " "))).size(), 8u);
}

TEST_F(ReadShapes, TurnRasToLps) {
    EXPECT_EQ(read_points(file("a.xyz", rows(8, " ")), Frame::ras)[3], Vec3(-3, 2.5, 10));
}

TEST_F(ReadShapes, SayWhichLineIsNotThreeNumbers) {
    for (const std::string bad : {"1,2\n", "1,2,3,4\n", "1,two,3\n", "1,2,3x\n"}) {
        expect_error(ErrorCode::input_unreadable, "line 10",
                     [&] { read_points(file("a.csv", "x,y,z\n" + rows(8, ",") + bad)); });
    }
}

TEST_F(ReadShapes, RefuseWhatIsNoCloud) {
    expect_error(ErrorCode::input_unreadable, "no such file",
                 [&] { read_points(folder / "nowhere.csv"); });
    expect_error(ErrorCode::input_unreadable, "empty", [&] { read_points(file("a.csv", "")); });
    expect_error(ErrorCode::input_unreadable, ".csv, .txt",
                 [&] { read_points(file("a.nii", "some")); });
    expect_error(ErrorCode::input_unusable, "at least 8",
                 [&] { read_points(file("a.csv", rows(7, ","))); });
    expect_error(ErrorCode::input_unusable, "point 9",
                 [&] { read_points(file("a.csv", rows(8, ",") + "1,nan,2\n")); });
    expect_error(ErrorCode::input_unusable, "point 9",
                 [&] { read_points(file("a.csv", rows(8, ",") + "1,inf,2\n")); });
}

TEST_F(ReadShapes, CutPolygonsMergePointsAndDropWhatHasNoArea) {
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(pyramid());
    writer->SetFileName((folder / "a.vtp").c_str());
    writer->Write();
    vtkNew<vtkPolyDataWriter> legacy;
    legacy->SetInputData(pyramid());
    legacy->SetFileName((folder / "a.vtk").c_str());
    legacy->Write();

    for (const char* name : {"a.vtp", "a.vtk"}) {
        const Surface surface = read_surface(folder / name);
        EXPECT_EQ(surface.vertices.size(), 5u) << name;
        EXPECT_EQ(surface.triangles.size(), 6u) << name;
        EXPECT_NEAR(enclosed_volume(surface), 4, 1e-12) << name;
    }
}

TEST_F(ReadShapes, TakePlyStlAndObj) {
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
        "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n4 0 0\n0 3 0\n3 0 1 2\n";
    const std::string stl =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 0 0\nvertex 0 3 0\n"
        "endloop\nendfacet\nendsolid a\n";
    const std::string obj = "v 0 0 0\nv 4 0 0\nv 0 3 0\nf 1 2 3\n";

    for (const auto& path : {file("a.ply", ply), file("a.stl", stl), file("a.obj", obj)}) {
        const Surface surface = read_surface(path, Frame::ras);
        ASSERT_EQ(surface.triangles.size(), 1u) << path;
        EXPECT_NEAR(surface_area(surface), 6, 1e-6) << path;
        double left = 0;
        for (const Vec3& x : surface.vertices) left = std::min(left, x[0]);
        EXPECT_NEAR(left, -4, 1e-6) << path;
    }
}

TEST_F(ReadShapes, TakePointsWithoutTriangles) {
    std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n" +
        rows(9, " ");
    EXPECT_EQ(read_points(file("a.ply", ply)).size(), 9u);
    expect_error(ErrorCode::input_unusable, "--target-points",
                 [&] { read_surface(file("a.ply", ply)); });
}

TEST_F(ReadShapes, RefuseDamagedFiles) {
    for (const char* name : {"a.vtp", "a.vtk", "a.ply", "a.stl", "a.obj"}) {
        const fs::path path = file(name, "this is not what its name says\n1 2 3\n");
        EXPECT_THROW(read_surface(path), Error) << name;
    }
    expect_error(ErrorCode::input_unreadable, ".stl",
                 [&] { read_surface(file("a.csv", rows(9, ","))); });
}

}  // namespace
}  // namespace palpate
