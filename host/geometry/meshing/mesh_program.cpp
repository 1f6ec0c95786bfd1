// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/mesh_program.hpp"

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {

namespace {

namespace fs = std::filesystem;

constexpr const char* program_name = "palpate-mesh";

bool is_program(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error) && access(path.c_str(), X_OK) == 0;
}

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

std::vector<fs::path> usual_places() {
    std::vector<fs::path> places;
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path folder = self.parent_path();
        places.push_back(folder / program_name);
        places.push_back(folder.parent_path() / "libexec" / "palpate" / program_name);
        places.push_back(folder.parent_path() / "libexec" / program_name);
    }
    std::istringstream path(environment("PATH"));
    for (std::string folder; std::getline(path, folder, ':');)
        if (fs::path(folder).is_absolute()) places.push_back(fs::path(folder) / program_name);
    return places;
}

}  // namespace

fs::path find_mesh_program(const fs::path& given) {
    const std::string named = given.empty() ? environment("PALPATE_MESH") : given.string();
    if (!named.empty()) {
        if (is_program(named)) return named;
        throw Error(ErrorCode::mesh_failed,
                    "the meshing program '" + named + "' does not exist or cannot be run");
    }
    for (const fs::path& place : usual_places())
        if (is_program(place)) return place;
    throw Error(
        ErrorCode::mesh_failed,
        "the meshing program palpate-mesh was not found beside this program or in PATH: "
        "build it with -DPALPATE_WITH_MESHER=ON (it needs TetGen or CGAL), set PALPATE_MESH, or "
        "give a ready mesh with --mesh");
}

}  // namespace palpate
