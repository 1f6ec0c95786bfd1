// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_mesh.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "solver/base/error.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate::bench {
namespace {

static_assert(std::endian::native == std::endian::little, "bench meshes are little-endian");
static_assert(sizeof(Vec3) == 24 && sizeof(Tet) == 16 && sizeof(LinearElastic) == 16);

constexpr char magic[8] = {'P', 'A', 'L', 'P', 'M', 'E', 'S', 'H'};
constexpr std::uint32_t version = 1;
constexpr std::uint32_t most_nodes = 1u << 28, most_tets = 1u << 30, most_materials = 1u << 16;

struct Header {
    char magic[8];
    std::uint32_t version, num_nodes, num_tets, num_materials;
};
static_assert(sizeof(Header) == 24);

[[noreturn]] void unreadable(const std::filesystem::path& path, const std::string& why) {
    throw Error(ErrorCode::input_unreadable,
                fmt::format("The bench mesh {} {}.", path.string(), why));
}

std::uint64_t file_bytes(const Header& h) {
    return sizeof(Header) + std::uint64_t{h.num_nodes} * (24 + 24 + 3) +
           std::uint64_t{h.num_materials} * 16 + std::uint64_t{h.num_tets} * (16 + 4);
}

void check_header(const std::filesystem::path& path, const Header& header, std::uint64_t bytes) {
    if (std::memcmp(header.magic, magic, sizeof magic) != 0)
        unreadable(path, "is not one: its first bytes differ from PALPMESH");
    if (header.version != version)
        unreadable(path, fmt::format("has version {}, this program reads version {}; make it again "
                                     "with make_bench_meshes",
                                     header.version, version));
    if (header.num_nodes > most_nodes || header.num_tets > most_tets ||
        header.num_materials > most_materials)
        unreadable(path, fmt::format("claims {} nodes, {} tetrahedra and {} materials",
                                     header.num_nodes, header.num_tets, header.num_materials));
    if (file_bytes(header) != bytes)
        unreadable(path, fmt::format("has {} bytes, its header asks for {}: it is damaged", bytes,
                                     file_bytes(header)));
}

template <typename Value>
void write_array(std::ofstream& file, const Value* values, std::size_t count) {
    file.write(reinterpret_cast<const char*>(values),
               static_cast<std::streamsize>(count * sizeof(Value)));
}

template <typename Value>
void read_array(std::ifstream& file, Value* values, std::size_t count) {
    file.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(Value)));
}

/// 5 x 5 x 5 cubes, pulled at the top face: small enough for every machine and every back end.
BenchMesh make_box() {
    BenchMesh box{"box", fixtures::two_tissue_model({5, 5, 5}), {}};
    Model& model = box.model;
    const auto top =
        fixtures::select_nodes(model.mesh, [](const Vec3& p) { return p.z() > 50 - 1e-9; });
    fixtures::prescribe(model, top);
    box.prescribed_mm = Columns::Zero(model.num_dofs(), 1);
    for (Index n : top) box.prescribed_mm(3 * n + 2, 0) = 2.0;
    return box;
}

}  // namespace

void write_bench_mesh(const std::filesystem::path& path, const BenchMesh& mesh) {
    const Model& model = mesh.model;
    Header header{};
    std::memcpy(header.magic, magic, sizeof magic);
    header.version = version;
    header.num_nodes = static_cast<std::uint32_t>(model.mesh.nodes.size());
    header.num_tets = static_cast<std::uint32_t>(model.mesh.tets.size());
    header.num_materials = static_cast<std::uint32_t>(model.materials.size());

    const std::filesystem::path unfinished = path.string() + ".part";
    std::ofstream file(unfinished, std::ios::binary);
    write_array(file, &header, 1);
    write_array(file, model.mesh.nodes.data(), model.mesh.nodes.size());
    write_array(file, mesh.prescribed_mm.data(), model.prescribed.size());
    write_array(file, model.materials.data(), model.materials.size());
    write_array(file, model.mesh.tets.data(), model.mesh.tets.size());
    write_array(file, model.mesh.region.data(), model.mesh.region.size());
    write_array(file, model.prescribed.data(), model.prescribed.size());
    file.close();
    std::error_code error;
    if (file) std::filesystem::rename(unfinished, path, error);
    if (!file || error)
        throw Error(ErrorCode::output_failed,
                    fmt::format("The bench mesh {} could not be written; is there a folder of that "
                                "name, and room on the disk?",
                                path.string()));
}

BenchMesh read_bench_mesh(const std::filesystem::path& path) {
    std::error_code error;
    const std::uint64_t bytes = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file) unreadable(path, "cannot be opened; make_bench_meshes FOLDER writes it");
    Header header{};
    if (bytes < sizeof header) unreadable(path, "is shorter than its header");
    read_array(file, &header, 1);
    check_header(path, header, bytes);

    BenchMesh mesh{path.stem().string(), {}, {}};
    Model& model = mesh.model;
    model.mesh.nodes.resize(header.num_nodes);
    model.mesh.tets.resize(header.num_tets);
    model.mesh.region.resize(header.num_tets);
    model.materials.resize(header.num_materials);
    model.prescribed.resize(3 * model.mesh.nodes.size());
    mesh.prescribed_mm.resize(model.num_dofs(), 1);
    read_array(file, model.mesh.nodes.data(), model.mesh.nodes.size());
    read_array(file, mesh.prescribed_mm.data(), model.prescribed.size());
    read_array(file, model.materials.data(), model.materials.size());
    read_array(file, model.mesh.tets.data(), model.mesh.tets.size());
    read_array(file, model.mesh.region.data(), model.mesh.region.size());
    read_array(file, model.prescribed.data(), model.prescribed.size());
    if (!file) unreadable(path, "cannot be read to its end");
    check_model(model);
    return mesh;
}

const std::vector<std::string>& bench_mesh_names() {
    static const std::vector<std::string> names = {"box", "pelvis_18k", "pelvis_90k", "pelvis_300k",
                                                   "pelvis_1M"};
    return names;
}

std::filesystem::path take_mesh_folder(int& argc, char** argv) {
    const std::string option = "--meshes=";
    const char* variable = std::getenv("PALPATE_BENCH_MESHES");
    std::filesystem::path folder = variable ? variable : "";
    int kept = 1;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.starts_with(option))
            folder = argument.substr(option.size());
        else
            argv[kept++] = argv[i];
    }
    argc = kept;
    return folder;
}

const BenchMesh& bench_mesh(const std::filesystem::path& folder, const std::string& name) {
    static BenchMesh current;
    if (current.name == name) return current;
    current = {};
    if (name == "box") return current = make_box();
    if (folder.empty())
        throw Error(ErrorCode::input_unreadable,
                    "No folder of bench meshes is known; make one with make_bench_meshes FOLDER, "
                    "then set PALPATE_BENCH_MESHES or give --meshes=FOLDER.");
    return current = read_bench_mesh(folder / (name + ".mesh"));
}

}  // namespace palpate::bench
