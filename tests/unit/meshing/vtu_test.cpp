// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "host/geometry/meshing/mesh_files.hpp"
#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

Mesh two_tets() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1.0 / 3}},
            {{0, 1, 2, 3}, {1, 2, 3, 4}},
            {2, 5}};
}

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

ErrorCode code_of(const fs::path& path, const std::string& region = "region",
                  std::string* message = nullptr) {
    try {
        read_vtu(path, region);
    } catch (const Error& error) {
        if (message) *message = error.what();
        return error.code();
    }
    return ErrorCode::internal;
}

fs::path data(const std::string& name) {
    const char* root = std::getenv("PALPATE_DATA");
    return root ? fs::path(root) / name : fs::path();
}

const char* legacy_head = "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n";

TEST(Vtu, returns_the_mesh_and_its_arrays_bit_for_bit) {
    const PrivateFolder folder;
    const fs::path path = folder.path() / "mesh.vtu";
    const Mesh mesh = two_tets();
    MeshArrays arrays;
    arrays.point_scalars["pressure"] = {1, 2, 3, 4, 1.0 / 7};
    arrays.point_vectors["displacement"] = {
        {1, 2, 3}, {0, 0, 0}, {0, 1, 0}, {9, 9, 9}, {1e-9, 0, 5}};
    arrays.cell_scalars["stiffness"] = {10, 1.0 / 3};
    write_vtu(path, mesh, arrays);
    MeshArrays back;
    const Mesh copy = read_vtu(path, "region", &back);
    EXPECT_EQ(copy.nodes, mesh.nodes);
    EXPECT_EQ(copy.tets, mesh.tets);
    EXPECT_EQ(copy.region, mesh.region);
    EXPECT_EQ(back.point_scalars, arrays.point_scalars);
    EXPECT_EQ(back.point_vectors, arrays.point_vectors);
    EXPECT_EQ(back.cell_scalars, arrays.cell_scalars);
}

TEST(Vtu, says_lps_and_holds_compressed_appended_data) {
    const PrivateFolder folder;
    write_vtu(folder.path() / "mesh.vtu", two_tets(), {});
    const std::string text = bytes_of(folder.path() / "mesh.vtu");
    EXPECT_NE(text.find("Name=\"SPACE\""), std::string::npos);
    EXPECT_NE(text.find("vtkZLibDataCompressor"), std::string::npos);
    EXPECT_NE(text.find("<AppendedData encoding=\"raw\">"), std::string::npos);
}

TEST(Vtu, refuses_arrays_of_the_wrong_length) {
    MeshArrays arrays;
    arrays.point_scalars["short"] = {1};
    EXPECT_THROW(write_vtu("/tmp/never_written.vtu", two_tets(), arrays), Error);
}

TEST(Vtu, says_that_a_folder_does_not_exist) {
    try {
        write_vtu("/nowhere/mesh.vtu", two_tets(), {});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::output_failed);
    }
}

TEST(Vtu, refuses_missing_and_empty_files_and_other_names) {
    const PrivateFolder folder;
    EXPECT_EQ(code_of(folder.path() / "absent.vtu"), ErrorCode::input_unreadable);
    EXPECT_EQ(code_of(folder.path()), ErrorCode::input_unreadable);
    std::ofstream(folder.path() / "empty.vtu");
    EXPECT_EQ(code_of(folder.path() / "empty.vtu"), ErrorCode::input_unreadable);
    std::ofstream(folder.path() / "mesh.stl") << "solid";
    EXPECT_EQ(code_of(folder.path() / "mesh.stl"), ErrorCode::input_unreadable);
}

TEST(Vtu, refuses_a_file_cut_at_any_place_without_printing) {
    const PrivateFolder folder;
    const fs::path path = folder.path() / "mesh.vtu";
    write_vtu(path, two_tets(), {});
    const std::string whole = bytes_of(path);
    ::testing::internal::CaptureStderr();
    // the last bytes only close the file
    const std::size_t end_of_data = whole.find("</AppendedData>") - 8;
    for (std::size_t length = 1; length < end_of_data; length += 37) {
        std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
        EXPECT_EQ(code_of(path), ErrorCode::input_unreadable) << "cut at " << length;
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Vtu, turns_inverted_tets_and_drops_nodes_without_a_tet) {
    const PrivateFolder folder;
    const fs::path path = folder.path() / "mesh.vtk";
    std::ofstream(path) << legacy_head
                        << "POINTS 5 double\n9 9 9 0 0 0 1 0 0 0 1 0 0 0 1\n"
                           "CELLS 2 9\n4 1 3 2 4\n3 1 2 3\nCELL_TYPES 2\n10\n5\n"
                           "POINT_DATA 5\nSCALARS t double 1\nLOOKUP_TABLE default\n0 1 2 3 4\n"
                           "CELL_DATA 2\nSCALARS region int 1\nLOOKUP_TABLE default\n7 9\n";
    MeshArrays arrays;
    const Mesh mesh = read_vtu(path, "region", &arrays);
    ASSERT_EQ(mesh.num_nodes(), 4);
    ASSERT_EQ(mesh.num_tets(), 1);
    EXPECT_NEAR(tet_volume(mesh, 0), 1.0 / 6, 1e-15);
    EXPECT_EQ(mesh.region, (std::vector<Index>{7}));
    EXPECT_EQ(arrays.point_scalars["t"], (std::vector<double>{1, 2, 3, 4}));
}

TEST(Vtu, refuses_nodes_out_of_range_flat_tets_and_fractional_labels) {
    const PrivateFolder folder;
    const fs::path path = folder.path() / "mesh.vtk";
    const auto code = [&](const std::string& points, const std::string& cell,
                          const std::string& label) {
        std::ofstream(path) << legacy_head << "POINTS 4 double\n"
                            << points << "\nCELLS 1 5\n4 " << cell
                            << "\nCELL_TYPES 1\n10\nCELL_DATA 1\n"
                            << "SCALARS region double 1\nLOOKUP_TABLE default\n"
                            << label << "\n";
        return code_of(path);
    };
    const std::string good = "0 0 0 1 0 0 0 1 0 0 0 1";
    EXPECT_EQ(code(good, "0 1 2 3", "4"), ErrorCode::internal);  // is read
    EXPECT_EQ(code(good, "0 1 2 4", "4"), ErrorCode::input_unreadable);
    EXPECT_EQ(code(good, "0 1 2 -1", "4"), ErrorCode::input_unreadable);
    EXPECT_EQ(code("0 0 0 1 0 0 0 1 0 1 1 0", "0 1 2 3", "4"), ErrorCode::input_unusable);
    EXPECT_EQ(code("0 0 0 1 0 0 0 1 0 0 0 nan", "0 1 2 3", "4"), ErrorCode::input_unreadable);
    EXPECT_EQ(code(good, "0 1 2 3", "4.5"), ErrorCode::input_unusable);
    EXPECT_EQ(code(good, "0 1 2 3", "-4"), ErrorCode::input_unusable);
}

TEST(Vtu, reads_the_legacy_format_as_vtk_9_writes_it) {
    const PrivateFolder folder;
    const fs::path path = folder.path() / "mesh.vtk";
    const auto write = [&](const std::string& types) {
        std::ofstream(path) << "# vtk DataFile Version 5.1\na\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                               "POINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 3 8\n"
                               "OFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n"
                               "0 1 2 3 1 2 3 4\n"
                            << types
                            << "\n\nCELL_DATA 2\nSCALARS region int 1\nLOOKUP_TABLE default\n7 9\n";
    };
    write("CELL_TYPES 2\n10\n10");
    const Mesh mesh = read_vtu(path);
    EXPECT_EQ(mesh.num_tets(), 2);
    EXPECT_EQ(mesh.region, (std::vector<Index>{7, 9}));
    write("CELL_TYPES 1\n10");
    EXPECT_EQ(code_of(path), ErrorCode::input_unreadable);
}

TEST(Vtu, refuses_points_without_cells_and_cells_without_types) {
    const PrivateFolder folder;
    const fs::path path = folder.path() / "mesh.vtk";
    const std::string points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n";
    std::ofstream(path) << legacy_head << points;
    EXPECT_EQ(code_of(path), ErrorCode::input_unusable);
    std::ofstream(path) << legacy_head << points
                        << "CELLS 2 10\n4 0 1 2 3\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
    EXPECT_EQ(code_of(path), ErrorCode::input_unreadable);
}

TEST(Vtu, asks_for_a_region_array_where_a_real_mesh_has_none) {
    const fs::path liver = data("liver_known_force_inria/liver_tets.vtk");
    if (!fs::exists(liver)) GTEST_SKIP() << "no liver_known_force_inria under PALPATE_DATA";
    std::string message;
    EXPECT_EQ(code_of(liver, "region", &message), ErrorCode::input_unusable);
    EXPECT_NE(message.find("region"), std::string::npos) << message;
}

TEST(Vtu, asks_for_a_region_array_where_a_real_vtu_has_none) {
    const fs::path tongue = data("organ_meshes_sofa/tongue_tets.vtu");
    if (!fs::exists(tongue)) GTEST_SKIP() << "no organ_meshes_sofa under PALPATE_DATA";
    std::string message;
    EXPECT_EQ(code_of(tongue, "region", &message), ErrorCode::input_unusable);
    EXPECT_NE(message.find("cell array 'region'"), std::string::npos) << message;
}

TEST(Vtu, reads_a_real_vtu_once_it_has_labels) {
    const fs::path tongue = data("organ_meshes_sofa/tongue_tets.vtu");
    if (!fs::exists(tongue)) GTEST_SKIP() << "no organ_meshes_sofa under PALPATE_DATA";
    std::string text = bytes_of(tongue);
    const std::string end_of_cells = "</Cells>";
    const std::size_t at = text.find(end_of_cells);
    ASSERT_NE(at, std::string::npos);
    std::string labels = "<CellData><DataArray type=\"Int32\" Name=\"region\" format=\"ascii\">";
    for (int i = 0; i < 10980; ++i) labels += "3 ";
    if (const std::size_t old = text.find("<CellData"); old != std::string::npos)
        GTEST_SKIP() << "the file has cell data of its own";
    text.insert(at + end_of_cells.size(), labels + "</DataArray></CellData>");
    const PrivateFolder folder;
    std::ofstream(folder.path() / "tongue.vtu", std::ios::binary) << text;
    const Mesh mesh = read_vtu(folder.path() / "tongue.vtu");
    EXPECT_EQ(mesh.num_nodes(), 2238);
    EXPECT_EQ(mesh.num_tets(), 10980);
    double volume = 0;
    for (Index t = 0; t < mesh.num_tets(); ++t) volume += tet_volume(mesh, t);
    EXPECT_NEAR(volume, 2.45, 0.01);
}

}  // namespace
}  // namespace palpate
