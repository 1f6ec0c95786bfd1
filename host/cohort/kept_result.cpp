// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/kept_result.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "host/apps/recover/report/recovery_tree.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/cohort/content_key.hpp"
#include "host/geometry/meshing/solid_mesh_file.hpp"
#include "host/io/files.hpp"
#include "host/io/gzip.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/tree_json.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "npy_of writes numbers as they are");

std::vector<Vec3> forces_of_held(const RecoveryResult& result) {
    std::vector<Vec3> forces;
    for (std::size_t node = 0; node < result.held.size(); ++node)
        if (result.held[node] != Held::free) forces.push_back(result.force[node]);
    return forces;
}

constexpr const char* facts_name = "facts.gz";
constexpr std::size_t most_bytes = 1u << 30;  // of one file, inflated
constexpr std::size_t npy_start_bytes = 10;   // before the header's text

std::string gzipped_text(const std::string& bytes) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    const std::vector<std::uint8_t> packed = gzipped({first, bytes.size()});
    return {packed.begin(), packed.end()};
}

std::string inflated_text(const std::string& packed) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(packed.data());
    const std::vector<std::uint8_t> bytes = inflated({first, packed.size()}, most_bytes);
    return {bytes.begin(), bytes.end()};
}

/// `read` of the file's text; its errors name the file.
template <typename Read>
auto read_file(const fs::path& path, const Read& read) {
    const std::string text = text_of_file(path);
    try {
        return read(text);
    } catch (const Error& error) {
        throw Error(error.code(),
                    fmt::format("{}: {}; run the case again", path.string(), error.what()));
    }
}

/// Of nodes, regions and what holds them.
std::string hash_of_mesh(const RecoveryResult& result) {
    std::string bytes = npy_of(result.mesh.nodes);
    for (const Index region : result.mesh.region) bytes += fmt::format("{},", region);
    for (const Held held : result.held) bytes += static_cast<char>('0' + static_cast<int>(held));
    return sha256_of(bytes).substr(0, 12);
}

}  // namespace

std::string npy_of(const std::vector<Vec3>& rows) {
    std::string header =
        fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, 3), }}", rows.size());
    constexpr std::size_t alignment = 64;
    header.append(alignment - (npy_start_bytes + header.size() + 1) % alignment, ' ');
    header += '\n';
    std::string file("\x93NUMPY\x01\x00", 8);
    file += static_cast<char>(header.size() & 255);
    file += static_cast<char>(header.size() >> 8);
    file += header;
    for (const Vec3& row : rows) {
        const Eigen::Vector3f single = row.cast<float>();
        file.append(reinterpret_cast<const char*>(single.data()), 3 * sizeof(float));
    }
    return file;
}

std::vector<Vec3> rows_of_npy(const std::string& file) {
    if (file.size() < npy_start_bytes || !file.starts_with("\x93NUMPY"))
        throw Error(ErrorCode::input_unreadable, "it is no array of NumPy");
    const std::size_t header =
        std::size_t(std::uint8_t(file[8])) + 256 * std::size_t(std::uint8_t(file[9]));
    constexpr std::size_t row_bytes = 3 * sizeof(float);
    const std::size_t start = npy_start_bytes + header;
    if (start > file.size() || (file.size() - start) % row_bytes != 0)
        throw Error(ErrorCode::input_unreadable, "it is cut off");
    std::vector<Vec3> rows;
    for (std::size_t at = start; at < file.size(); at += row_bytes) {
        Eigen::Vector3f row;
        std::memcpy(row.data(), file.data() + at, row_bytes);
        rows.push_back(row.cast<double>());
    }
    return rows;
}

void write_kept_result(const RecoveryResult& result, KeptFiles keep, const fs::path& inside) {
    if (keep == KeptFiles::all) return write_result_files(result, inside, {});
    write_text_file(inside / "result.json",
                    tree_json(recovery_tree(result, false, FieldChoice::none)));
    if (keep == KeptFiles::table) return;
    write_text_file(inside / "displacement.npy", npy_of(result.displacement));
    write_text_file(inside / "force.npy", npy_of(forces_of_held(result)));
    write_text_file(inside / facts_name, gzipped_text(facts_bytes(result)));
}

std::string body_name_of(const std::string& mesh_name) {
    return "body-" + fs::path(mesh_name).stem().string().substr(std::strlen("mesh-")) + ".gz";
}

CompactResult read_compact_result(const fs::path& case_folder, const fs::path& body) {
    CompactResult kept;
    kept.facts = read_file(case_folder / facts_name, inflated_text);
    kept.displacement = read_file(case_folder / "displacement.npy", rows_of_npy);
    kept.force = read_file(case_folder / "force.npy", rows_of_npy);
    kept.body =
        read_file(body, [](const std::string& text) { return body_of(inflated_text(text)); });
    return kept;
}

std::string keep_mesh(const RecoveryResult& result, const std::string& body,
                      const fs::path& reference) {
    const std::string name = fmt::format("mesh-{}.vtu", hash_of_mesh(result));
    if (fs::exists(reference / name)) return name;
    make_folders(reference);
    replace_text(reference / body_name_of(name), gzipped_text(body));
    SolidMesh mesh = result.mesh;
    for (Index& region : mesh.region)
        for (const RegionResult& r : result.regions)
            if (r.region == region) {
                region = r.label;
                break;
            }
    SolidMeshArrays arrays;
    for (const Held held : result.held)
        arrays.point_scalars["held"].push_back(static_cast<double>(held));
    write_atomically(reference / name,
                     [&](const fs::path& temporary) { write_solid_mesh(temporary, mesh, arrays); });
    return name;
}

}  // namespace palpate
