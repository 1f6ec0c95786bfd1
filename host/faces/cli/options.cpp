// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/cli/options.hpp"

#include "solver/backend/registry.hpp"
#include "solver/linear/factor_libraries.hpp"

namespace palpate {
namespace {

LinearMethod method_named(const std::string& name) {
    for (const LinearMethod method :
         {LinearMethod::multigrid, LinearMethod::jacobi, LinearMethod::direct})
        if (name == name_of(method)) return method;
    return LinearMethod::automatic;
}

std::vector<std::string> backend_choices() {
    std::vector<std::string> choices = {"auto"};
    for (const BackendEntry& entry : backend_registry()) choices.push_back(entry.name);
    return choices;
}

std::vector<std::string> factorisation_choices() {
    std::vector<std::string> choices = {"auto"};
    for (const std::string& name : sparse_factor_names()) choices.push_back(name);
    return choices;
}

LinearSolverOptions unchecked_options(const SolverArguments& arguments) {
    LinearSolverOptions options;
    options.backend =
        arguments.backend == "auto" ? backend_registry().front().name : arguments.backend;
    options.device.device = arguments.device;
    options.device.precision =
        arguments.precision == "double" ? Precision::double_ : Precision::single;
    for (Product product :
         {Product::automatic, Product::assembled, Product::matrix_free, Product::recomputed})
        if (name_of(product) == arguments.product) options.device.product = product;
    options.method = method_named(arguments.linear_solver);
    if (arguments.factorisation != "auto") options.direct_library = arguments.factorisation;
    return options;
}

}  // namespace

void add_tangent_options(CLI::App& command, SolverArguments& arguments) {
    command
        .add_option("--backend", arguments.backend,
                    "Who computes: auto (the first of these), or one of this build: OpenCL, Kokkos "
                    "(what it was built for), reference (host)")
        ->check(CLI::IsMember(backend_choices()))
        ->capture_default_str();
    command.add_option("--device", arguments.device,
                       "OpenCL device: a number such as 0.1 or part of its name, see `palpate "
                       "devices` (default: the first GPU, else the first CPU)");
    command
        .add_option("--precision", arguments.precision,
                    "Arithmetic on the device; single is refined to double on the host")
        ->check(CLI::IsMember({"single", "double"}))
        ->capture_default_str();
    command
        .add_option("--linear-solver", arguments.linear_solver,
                    "How equations are solved: auto (by size, number of columns and device), "
                    "multigrid (large meshes), jacobi (little memory), or direct (on the host; "
                    "many columns, small meshes)")
        ->check(CLI::IsMember({"auto", "multigrid", "jacobi", "direct"}))
        ->capture_default_str();
    command
        .add_option("--factorisation", arguments.factorisation,
                    "Library of direct solves: auto (the first of these), or one of this build: "
                    "mumps, cholmod (GPL), eigen (slow)")
        ->check(CLI::IsMember(factorisation_choices()))
        ->capture_default_str();
}

void add_solver_options(CLI::App& command, SolverArguments& arguments) {
    add_tangent_options(command, arguments);
    command
        .add_option("--product", arguments.product,
                    "Stiffness product on the device: assembled, matrix-free (stored gradients), "
                    "recomputed (from node positions), or auto: the fastest, measured at first use")
        ->check(CLI::IsMember({"auto", "assembled", "matrix-free", "recomputed"}))
        ->capture_default_str();
}

void add_mesher_options(CLI::App& command, MesherArguments& arguments) {
    command
        .add_option("--mesher", arguments.mesher,
                    "auto (TetGen, then CGAL if it fails), tetgen, or cgal")
        ->check(CLI::IsMember({"auto", "tetgen", "cgal"}))
        ->capture_default_str();
    command.add_option("--nodes", arguments.nodes, "Wanted number of mesh nodes")
        ->check(CLI::Range(500, 500000))
        ->capture_default_str();
    command.add_option("--mesh-time-limit", arguments.time_limit_s, "Seconds for the mesher")
        ->check(CLI::Range(1.0, 86400.0))
        ->capture_default_str();
    command.add_option("--mesh-memory-limit", arguments.memory_limit_gib, "GiB for the mesher")
        ->check(CLI::Range(0.25, 1024.0))
        ->capture_default_str();
}

LinearSolverOptions solver_options(const SolverArguments& arguments) {
    const LinearSolverOptions options = unchecked_options(arguments);
    make_backend(options.backend, options.device);  // a missing device is told before any work
    return options;
}

MatrixSolverOptions tangent_options(const SolverArguments& arguments) {
    const LinearSolverOptions options = unchecked_options(arguments);
    const bool is_by_name = arguments.backend != "auto" || !arguments.device.empty() ||
                            options.method == LinearMethod::multigrid ||
                            options.method == LinearMethod::jacobi;
    if (is_by_name && options.method != LinearMethod::direct)
        make_backend(options.backend, options.device);
    return matrix_solver_options(options);
}

MesherOptions mesher_options(const MesherArguments& arguments) {
    MesherOptions options;
    if (arguments.mesher == "tetgen") options.kind = MesherKind::tetgen;
    if (arguments.mesher == "cgal") options.kind = MesherKind::cgal;
    options.num_nodes = arguments.nodes;
    options.time_limit_s = arguments.time_limit_s;
    options.memory_limit_gib = arguments.memory_limit_gib;
    return options;
}

}  // namespace palpate
