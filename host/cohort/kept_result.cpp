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
#include "host/io/output_folder.hpp"
#include "host/page/tree_json.hpp"

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
    constexpr std::size_t before = 10, alignment = 64;
    header.append(alignment - (before + header.size() + 1) % alignment, ' ');
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

void write_kept_result(const RecoveryResult& result, KeptFiles keep, const fs::path& inside) {
    if (keep == KeptFiles::all) return write_result_files(result, inside, {});
    write_text_file(inside / "result.json",
                    tree_json(recovery_tree(result, false, FieldChoice::none)));
    if (keep == KeptFiles::table) return;
    write_text_file(inside / "displacement.npy", npy_of(result.displacement));
    write_text_file(inside / "force.npy", npy_of(forces_of_held(result)));
}

std::string keep_mesh(const RecoveryResult& result, const fs::path& reference) {
    const std::string name = fmt::format("mesh-{}.vtu", hash_of_mesh(result));
    if (fs::exists(reference / name)) return name;
    make_folders(reference);
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
