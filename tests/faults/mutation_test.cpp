// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <random>
#include <sstream>

#include "host/apps/aspirate/profile_series.hpp"
#include "host/geometry/meshing/mesh_files.hpp"
#include "host/geometry/surfaces/read_shapes.hpp"
#include "host/io/decode_pictures.hpp"
#include "host/io/files.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "tests/fixtures/meshes.hpp"

// Damaged files of each format, read as users' files are. What the checks let through meets the
// decoder in a child, which may die; this process may not.
//   PALPATE_MUTATIONS=10000 build/release/bin/mutation_test     the long form
//   PALPATE_MUTATION_SEED=8 ..                                  other damage than that of CI
namespace palpate {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr double longest_read_s = 5;  // processor time of a child is limited to 60 s
constexpr long largest_child_kib = 2L << 20;

int wanted_number(const char* variable, int usual) {
    const char* wanted = std::getenv(variable);
    return wanted ? std::atoi(wanted) : usual;
}

Bytes bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

LabelImage small_scene() {
    LabelImage image;
    image.grid.size = {9, 8, 7};
    image.grid.origin = Vec3(1, 2, 3);
    image.grid.spacing = Vec3(0.5, 1, 2);
    image.voxels.assign(image.grid.num_voxels(), 0);
    for (std::size_t v = 100; v < 300; ++v) image.voxels[v] = 300;
    return image;
}

class Mutator {
public:
    explicit Mutator(std::uint32_t seed) : random_(seed) {}

    /// One to four changes: bytes flipped or set to extremes, digits changed, parts removed,
    /// doubled or cut off. The first 512 bytes hold the header and are hit most.
    Bytes operator()(Bytes bytes) {
        for (std::size_t k = 1 + below(4); k > 0; --k) change(bytes);
        return bytes;
    }

private:
    std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }

    void change(Bytes& bytes) {
        if (bytes.empty()) return;
        const std::size_t reach =
            below(4) == 0 ? bytes.size() : std::min<std::size_t>(512, bytes.size());
        const std::size_t at = below(reach);
        const std::size_t length = std::min(1 + below(16), bytes.size() - at);
        const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        const auto end = begin + static_cast<std::ptrdiff_t>(length);
        constexpr std::uint8_t extremes[] = {0x00, 0xff, 0x7f, 0x80, '-', '9', '\n', ' '};
        switch (below(7)) {
            case 0:
                *begin ^= static_cast<std::uint8_t>(1u << below(8));
                break;
            case 1:
                *begin = static_cast<std::uint8_t>(below(256));
                break;
            case 2:
                std::fill(begin, end, extremes[below(std::size(extremes))]);
                break;
            case 3:
                *begin = static_cast<std::uint8_t>('0' + below(10));
                break;
            case 4:
                bytes.erase(begin, end);
                break;
            case 5: {
                const Bytes part(begin, end);
                bytes.insert(begin, part.begin(), part.end());
                break;
            }
            default:
                if (below(4) == 0) bytes.resize(at);
        }
    }

    std::minstd_rand random_;
};

/// A kind of file that users give.
struct Format {
    std::string ending;
    void (*write)(const std::filesystem::path&);  ///< a good one
    void (*read)(const std::filesystem::path&);
};

void write_labels(const std::filesystem::path& path) { write_label_image(path, small_scene()); }

void read_labels(const std::filesystem::path& path) {
    const LabelImage image = read_label_image(path);
    EXPECT_EQ(image.voxels.size(), image.grid.num_voxels());
}

void write_field(const std::filesystem::path& path) {
    Image<Vec3> field;
    field.grid = small_scene().grid;
    field.voxels.assign(field.grid.num_voxels(), Vec3(0.5, -0.25, 1));
    write_displacement_transform(path, field);
}

void read_field(const std::filesystem::path& path) {
    const Image<Vec3> field = read_displacement_transform(path);
    EXPECT_EQ(field.voxels.size(), field.grid.num_voxels());
}

void write_rigid(const std::filesystem::path& path) {
    write_rigid_transform(path, {Mat3::Identity(), Vec3(1, 2, 3)});
}

void read_rigid(const std::filesystem::path& path) { read_rigid_transform(path); }

void write_mesh(const std::filesystem::path& path) {
    const Mesh mesh = fixtures::box_mesh({3, 3, 3}, Vec3(3, 3, 3));
    write_vtu(path, mesh, {{}, {{"displacement", mesh.nodes}}, {}});
}

void read_mesh(const std::filesystem::path& path) {
    MeshArrays arrays;
    const Mesh mesh = read_vtu(path, "region", &arrays);
    for (const auto& tet : mesh.tets)
        for (const Index node : tet) EXPECT_LT(node, mesh.num_nodes());
}

template <typename Rows>
std::string rows_of(const Rows& rows, const std::string& before) {
    std::ostringstream text;
    for (const auto& row : rows) text << before << row[0] << ' ' << row[1] << ' ' << row[2] << '\n';
    return text.str();
}

void write_legacy_mesh(const std::filesystem::path& path) {
    const Mesh mesh = fixtures::box_mesh({1, 1, 1}, Vec3(1, 1, 1));
    std::ofstream out(path);
    out << "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS "
        << mesh.num_nodes() << " double\n"
        << rows_of(mesh.nodes, "") << "CELLS " << mesh.num_tets() << ' ' << 5 * mesh.num_tets()
        << '\n';
    for (const Tet& t : mesh.tets)
        out << "4 " << t[0] << ' ' << t[1] << ' ' << t[2] << ' ' << t[3] << '\n';
    out << "CELL_TYPES " << mesh.num_tets() << '\n';
    for (Index t = 0; t < mesh.num_tets(); ++t) out << "10\n";
    out << "CELL_DATA " << mesh.num_tets() << "\nSCALARS region int 1\nLOOKUP_TABLE default\n";
    for (Index t = 0; t < mesh.num_tets(); ++t) out << "1\n";
}

/// An octahedron, which keeps nothing of what a mutation may hit but numbers and keywords.
constexpr double corners[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                  {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
constexpr int faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                             {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

void write_surface(const std::filesystem::path& path) {
    std::ofstream out(path);
    if (path.extension() == ".ply")
        out << "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
               "property float z\nelement face 8\nproperty list uchar int vertex_indices\n"
               "end_header\n"
            << rows_of(corners, "") << rows_of(faces, "3 ");
    if (path.extension() == ".vtk")
        out << "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 6 float\n"
            << rows_of(corners, "") << "POLYGONS 8 32\n"
            << rows_of(faces, "3 ");
    if (path.extension() == ".vtp")
        out << "<VTKFile type=\"PolyData\" version=\"0.1\"><PolyData><Piece NumberOfPoints=\"6\" "
               "NumberOfPolys=\"8\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
               "format=\"ascii\">"
            << rows_of(corners, "")
            << "</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" "
               "format=\"ascii\">"
            << rows_of(faces, "")
            << "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12 "
               "15 "
               "18 21 24</DataArray></Polys></Piece></PolyData></VTKFile>\n";
    if (path.extension() == ".obj") {
        out << rows_of(corners, "v ");
        for (const auto& face : faces)
            out << "f " << face[0] + 1 << ' ' << face[1] + 1 << ' ' << face[2] + 1 << '\n';
    }
    if (path.extension() == ".stl") {
        out << "solid a\n";
        for (const auto& face : faces) {
            out << "facet normal 0 0 0\nouter loop\n";
            for (const int k : face)
                out << "vertex " << corners[k][0] << ' ' << corners[k][1] << ' ' << corners[k][2]
                    << '\n';
            out << "endloop\nendfacet\n";
        }
        out << "endsolid a\n";
    }
}

void read_triangles(const std::filesystem::path& path) {
    const Surface surface = read_surface(path);
    for (const Triangle& t : surface.triangles)
        for (const Index corner : t) EXPECT_LT(corner, Index(surface.vertices.size()));
}

/// As ITK's own writer leaves it, 16 bits.
void write_picture(const std::filesystem::path& path) {
    std::vector<std::uint16_t> grey(24 * 20);
    for (std::size_t n = 0; n < grey.size(); ++n) grey[n] = std::uint16_t(137 * n);
    itk::ImageIOBase::Pointer encoder;
    if (path.extension() == ".png")
        encoder = itk::PNGImageIO::New().GetPointer();
    else
        encoder = itk::TIFFImageIO::New().GetPointer();
    encoder->SetFileName(path.string());
    encoder->SetNumberOfDimensions(2);
    encoder->SetDimensions(0, 24);
    encoder->SetDimensions(1, 20);
    encoder->SetComponentType(itk::IOComponentEnum::USHORT);
    encoder->SetPixelType(itk::IOPixelEnum::SCALAR);
    encoder->SetNumberOfComponents(1);
    itk::ImageIORegion region(2);
    region.SetSize(0, 24);
    region.SetSize(1, 20);
    encoder->SetIORegion(region);
    encoder->UseCompressionOn();
    encoder->WriteImageInformation();
    encoder->Write(grey.data());
}

void read_picture(const std::filesystem::path& path) {
    const GreyShape shape = shape_of_picture(path);
    if (shape.num_pixels() > (std::size_t(1) << 24)) return;  // a batch of frames is smaller
    EXPECT_EQ(decode_pictures({&path, 1}, shape).size(), shape.num_pixels());
}

/// Of three frames, times and places written as ProfileWriter does.
void write_profile_table(const std::filesystem::path& path) {
    std::ofstream out(path);
    out << "time_s,r_mm,z_mm,sd_mm,flag\n";
    for (const char* time : {"0", "0.04", "0.08"})
        for (int n = -3; n <= 3; ++n)
            out << time << ',' << 0.5 * n << ',' << 1.25 - 0.1 * n * n << ",0.012," << n % 2 + 1
                << '\n';
}

void read_profile_table(const std::filesystem::path& path) {
    double before_s = -std::numeric_limits<double>::infinity();
    for (const FrameProfile& frame : read_profiles(path)) {
        EXPECT_GT(frame.time_s, before_s);
        before_s = frame.time_s;
        for (const ProfilePoint& point : frame.points) {
            EXPECT_TRUE(std::isfinite(point.r_mm) && std::isfinite(point.z_mm));
            EXPECT_GT(point.sd_mm, 0);
        }
    }
}

struct Counts {
    int accepted = 0, refused = 0, child_died = 0;
    double slowest_s = 0;
    std::string said;  ///< of the last that was not read
};

bool is_of_a_dead_child(const std::string& message) {
    for (const char* word : {"crashed", "too long", "more memory", "without a result"})
        if (message.find(word) != std::string::npos) return true;
    return false;
}

void read_one(const Format& format, const std::filesystem::path& path, Counts& counts) {
    const auto begin = std::chrono::steady_clock::now();
    try {
        format.read(path);
        ++counts.accepted;
    } catch (const Error& error) {
        counts.said = error.what();
        const bool died = is_of_a_dead_child(counts.said);
        ++(died ? counts.child_died : counts.refused);
        EXPECT_TRUE(error.code() == ErrorCode::input_unreadable ||
                    (!died && error.code() == ErrorCode::input_unusable))
            << error.what();
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    counts.slowest_s = std::max(counts.slowest_s, spent.count());
}

class Mutation : public testing::TestWithParam<Format> {};

TEST_P(Mutation, OfAFileIsReadOrRefused) {
    const PrivateFolder folder;
    const std::filesystem::path path = folder.path() / ("a" + GetParam().ending);
    GetParam().write(path);
    const Bytes good = bytes_of(path);
    Mutator mutate(std::uint32_t(wanted_number("PALPATE_MUTATION_SEED", 7)));
    const int num_mutations = wanted_number("PALPATE_MUTATIONS", 400);
    Counts counts;
    read_one(GetParam(), path, counts);
    ASSERT_EQ(counts.accepted, 1) << "the good one: " << counts.said;
    counts = {};

    for (int k = 0; k < num_mutations; ++k) {
        const Bytes bytes = mutate(good);
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        read_one(GetParam(), path, counts);
    }

    rusage children{};
    getrusage(RUSAGE_CHILDREN, &children);
    std::cout << GetParam().ending << ": " << counts.accepted << " read, " << counts.refused
              << " refused, " << counts.child_died << " killed their child; slowest "
              << counts.slowest_s << " s, largest child " << children.ru_maxrss / 1024 << " MiB\n";
    EXPECT_GT(counts.accepted, 0);
    EXPECT_GT(counts.refused, 0);
    EXPECT_LT(counts.slowest_s, 4 * longest_read_s);  // the aim is 5 s; machines may be busy
    EXPECT_LT(children.ru_maxrss, largest_child_kib);
}

const Format formats[] = {
    {".nii", write_labels, read_labels},     {".nrrd", write_labels, read_labels},
    {".mha", write_labels, read_labels},     {".nii.gz", write_labels, read_labels},
    {".h5", write_field, read_field},        {".tfm", write_rigid, read_rigid},
    {".vtu", write_mesh, read_mesh},         {"_mesh.vtk", write_legacy_mesh, read_mesh},
    {".vtp", write_surface, read_triangles}, {".vtk", write_surface, read_triangles},
    {".ply", write_surface, read_triangles}, {".stl", write_surface, read_triangles},
    {".obj", write_surface, read_triangles}, {".png", write_picture, read_picture},
    {".tif", write_picture, read_picture},   {".csv", write_profile_table, read_profile_table},
};

INSTANTIATE_TEST_SUITE_P(Format, Mutation, testing::ValuesIn(formats), [](const auto& format) {
    std::string name = format.param.ending.substr(1);  // "_mesh.vtk": a file a_mesh.vtk
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
});

}  // namespace
}  // namespace palpate
