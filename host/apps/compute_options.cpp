// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/compute_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <thread>

#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/factor_libraries.hpp"

namespace palpate {
namespace {

LinearMethod method_named(const std::string& name) {
    for (const LinearMethod method :
         {LinearMethod::multigrid, LinearMethod::jacobi, LinearMethod::direct})
        if (name == name_of(method)) return method;
    return LinearMethod::automatic;
}

Product product_named(const std::string& name) {
    for (const Product product : {Product::assembled, Product::matrix_free, Product::recomputed})
        if (name == name_of(product)) return product;
    return Product::automatic;
}

std::string library_named(const std::string& name) {
    if (name == "auto") return "";
    const std::vector<std::string>& held = sparse_factor_names();
    if (std::find(held.begin(), held.end(), name) == held.end())
        throw Error(ErrorCode::unsupported,
                    fmt::format("factorisation \"{}\" is not compiled into this build; choose one "
                                "of: auto, {}",
                                name, fmt::join(held, ", ")));
    return name;
}

/// Without a look whether there is such a device.
LinearSolverOptions asked_solver(const OptionValues& values) {
    LinearSolverOptions options;
    const std::string backend = values.text("backend");
    options.backend = backend == "auto" ? backend_registry().front().name : backend;
    options.device.device = values.text("device");
    options.device.precision =
        values.text("precision") == "double" ? Precision::double_ : Precision::single;
    options.method = method_named(values.text("linear_solver"));
    options.direct_library = library_named(values.text("factorisation"));
    return options;
}

}  // namespace

std::vector<Option> tangent_options() {
    return {
        Option::choice("backend", {"auto", "opencl", "kokkos", "reference"},
                       "Back end that computes: auto (the first of this build), OpenCL, Kokkos, or "
                       "reference (host)")
            .usually(std::string("auto")),
        Option::text("device",
                     "OpenCL device: a number such as 0.1 or part of its name, see `palpate "
                     "devices`; default: the first GPU, else the first CPU"),
        Option::choice("precision", {"single", "double"},
                       "Arithmetic on the device; single is refined to double on the host")
            .usually(std::string("single")),
        Option::choice("linear_solver", {"auto", "multigrid", "jacobi", "direct"},
                       "How equations are solved: auto (by size, number of columns and device), "
                       "multigrid (large meshes), jacobi (little memory), or direct (on the host; "
                       "many columns, small meshes)")
            .usually(std::string("auto")),
        Option::choice("factorisation", {"auto", "mumps", "cholmod", "eigen"},
                       "Library of direct solves: auto (the first of this build), mumps, cholmod "
                       "(GPL), eigen (slow)")
            .usually(std::string("auto")),
    };
}

std::vector<Option> solver_options() {
    std::vector<Option> options = tangent_options();
    options.push_back(
        Option::choice("product", {"auto", "assembled", "matrix-free", "recomputed"},
                       "Stiffness product on the device: assembled, matrix-free (stored "
                       "gradients), recomputed (from node positions), or auto: the fastest, "
                       "measured at first use")
            .usually(std::string("auto")));
    return options;
}

std::vector<Option> mesher_options(Index num_nodes) {
    const MesherOptions usual;
    return {
        Option::choice("mesher", {"auto", "tetgen", "cgal"},
                       "auto (TetGen, then CGAL if it fails), tetgen, or cgal")
            .usually(std::string("auto")),
        Option::integer("nodes", 500, 500000,
                        "Wanted number of mesh nodes; more take longer and are more accurate")
            .usually(std::int64_t{num_nodes}),
        Option::number("mesh_time_limit", "s", {1, 86400}, "Time for the mesher")
            .usually(usual.time_limit_s),
        Option::number("mesh_memory_limit", "GiB", {0.25, 1024}, "Memory for the mesher")
            .usually(usual.memory_limit_gib),
        Option::input_file("mesh_program",
                           "Program that makes meshes; default: the palpate-mesh beside this "
                           "program, else the first on the PATH"),
    };
}

std::vector<Option> joined(std::initializer_list<std::vector<Option>> parts) {
    std::vector<Option> table;
    for (const auto& part : parts) table.insert(table.end(), part.begin(), part.end());
    return table;
}

LinearSolverOptions solver_of(const OptionValues& values) {
    LinearSolverOptions options = asked_solver(values);
    options.device.product = product_named(values.text("product"));
    make_backend(options.backend, options.device);  // a missing device is told before any work
    return options;
}

void take_tangent_options(const OptionValues& values, EquilibriumOptions& newton) {
    const LinearSolverOptions options = asked_solver(values);
    const bool is_by_name = values.text("backend") != "auto" || !options.device.device.empty() ||
                            options.method == LinearMethod::multigrid ||
                            options.method == LinearMethod::jacobi;
    if (is_by_name && options.method != LinearMethod::direct)
        make_backend(options.backend, options.device);
    newton.linear = matrix_solver_options(options);
    newton.loops = {newton.linear.backend, newton.linear.device, values.text("backend") != "auto"};
}

int jobs_of(const OptionValues& values) {
    if (values.is_given("jobs")) return values.integer("jobs");
    return int(std::max(1u, std::thread::hardware_concurrency()));
}

MesherOptions mesher_of(const OptionValues& values) {
    MesherOptions options;
    const std::string kind = values.text("mesher");
    if (kind == "tetgen") options.kind = MesherKind::tetgen;
    if (kind == "cgal") options.kind = MesherKind::cgal;
    options.num_nodes = static_cast<Index>(values.integer("nodes"));
    options.time_limit_s = values.number("mesh_time_limit");
    options.memory_limit_gib = values.number("mesh_memory_limit");
    options.program = values.path("mesh_program");
    return options;
}

}  // namespace palpate
