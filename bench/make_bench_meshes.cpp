// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Writes the meshes of the benchmarks: the pelvis phantom of seed 1 with a prostate of 60 kPa at
// four sizes. The same build writes the same files.
//   make_bench_meshes FOLDER [NAME...]     e.g. make_bench_meshes meshes pelvis_18k
#include <fmt/format.h>

#include <algorithm>

#include "bench/bench_mesh.hpp"
#include "host/apps/phantom/pelvis.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct Size {
    const char* name;
    Index num_nodes;  ///< asked for, so that about that many come
};
constexpr Size sizes[] = {
    {"pelvis_18k", 5300}, {"pelvis_90k", 30000}, {"pelvis_300k", 100000}, {"pelvis_1M", 333333}};

void write_size(const Size& size, const std::filesystem::path& folder) {
    PelvisOptions options;
    options.seed = 1;
    options.stiffness_kpa = 60;
    options.num_nodes = size.num_nodes;
    MesherOptions mesher;
    mesher.kind = MesherKind::tetgen;
    mesher.time_limit_s = 1800;
    WallProblem problem = make_pelvis_problem(options, mesher);
    const bench::BenchMesh mesh{size.name, std::move(problem.model),
                                std::move(problem.prescribed_mm)};
    const auto path = folder / (std::string(size.name) + ".mesh");
    bench::write_bench_mesh(path, mesh);
    const auto& prescribed = mesh.model.prescribed;
    fmt::print("{}: {} nodes, {} tets, {} dofs, {} of them prescribed\n", path.string(),
               mesh.model.mesh.num_nodes(), mesh.model.mesh.num_tets(), mesh.model.num_dofs(),
               std::count(prescribed.begin(), prescribed.end(), 1));
}

bool is_wanted(const std::string& name, const std::vector<std::string>& names) {
    return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

int run(const std::vector<std::string>& arguments) {
    if (arguments.empty() || arguments[0].starts_with("-")) {
        fmt::print(stderr, "make_bench_meshes: give the folder to write to\n");
        return exit_code_of(ErrorCode::invalid_argument);
    }
    const std::filesystem::path folder = arguments[0];
    std::filesystem::create_directories(folder);
    const std::vector<std::string> names(arguments.begin() + 1, arguments.end());
    for (const Size& size : sizes)
        if (is_wanted(size.name, names)) write_size(size, folder);
    return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    try {
        return palpate::run({argv + 1, argv + argc});
    } catch (const palpate::Error& error) {
        fmt::print(stderr, "make_bench_meshes: {}\n", error.what());
        return palpate::exit_code_of(error.code());
    } catch (const std::exception& error) {
        fmt::print(stderr, "make_bench_meshes: {}\n", error.what());
        return 1;
    }
}
