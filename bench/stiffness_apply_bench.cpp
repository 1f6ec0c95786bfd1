// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// How long does one iteration's work take on each back end, and how near is that to what memory
// gives? Row names are operation / mesh / back end / product / precision / columns.
// Counters: GB/s, the bytes that the operation cannot do without (formulas below) over the time;
// copy_GB/s, a copy with a working set of as many bytes, measured in the same run on the same
// device; copy_fraction, the first over the second.
//
//   stiffness_apply_bench --meshes=FOLDER --benchmark_filter='apply_stiffness/pelvis_18k/'
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/bench_mesh.hpp"
#include "bench/copy_bandwidth.hpp"
#include "bench/row_error.hpp"
#include "solver/backend/registry.hpp"
#include "solver/mesh/node_elements.hpp"
#include "solver/mesh/spatial_order.hpp"

namespace palpate::bench {
namespace {

/// What the formulas of bytes are written in.
struct Sizes {
    double nodes, tets, blocks;  ///< blocks: of 3x3 reals in the stiffness matrix
    double columns, real;        ///< real: bytes of one
    double vector() const { return 3 * nodes * columns * real; }
};

// Every array once, however often a kernel comes back to it: caches hold it at best. Indices have 4
// bytes, prescribed flags one per dof.

// blocks + block_node, row_start; x, y
double assembled_bytes(const Sizes& s) {
    return s.blocks * (9 * s.real + 4) + 4 * s.nodes + 2 * s.vector();
}

// elements, region, geometry (4 gradients less one, volume: 10 reals), node_start, node_corners,
// prescribed; 12 element forces per tet, written and read; x, y
double matrix_free_bytes(const Sizes& s) {
    return s.tets * (16 + 4 + 10 * s.real + 16) + s.nodes * (4 + 3) +
           2 * 12 * s.tets * s.columns * s.real + 2 * s.vector();
}

// elements, region, nodes, node_start, node_corners, prescribed; element forces, written and read;
// x, y
double recomputed_bytes(const Sizes& s) {
    return s.tets * (16 + 4 + 16) + s.nodes * (3 * s.real + 4 + 3) +
           2 * 12 * s.tets * s.columns * s.real + 2 * s.vector();
}

// inverse_blocks; r, z
double block_jacobi_bytes(const Sizes& s) { return 9 * s.nodes * s.real + 2 * s.vector(); }

using Bytes = double (*)(const Sizes&);

struct ProductEntry {
    Product product;
    const char* name;
    Bytes bytes;  ///< of y = K x
};
constexpr ProductEntry products[] = {
    {Product::assembled, "assembled", assembled_bytes},
    {Product::matrix_free, "matrix_free", matrix_free_bytes},
    {Product::recomputed, "recomputed", recomputed_bytes},
};

/// A back end with a prepared mesh and two vectors.
struct Bench {
    std::unique_ptr<Backend> backend;
    std::unique_ptr<Model> model;  ///< its nodes in the order in which solvers number them
    std::unique_ptr<DeviceVector> x, y, b, r;
    std::unique_ptr<DeviceSums> one, sums, more_sums;  ///< `one` holds ones
    Index columns = 1;
};

struct Operation {
    const char* name;
    std::function<void(Bench&)> run;
    Bytes bytes;  ///< nullptr: those of the product, one row per product
};

const std::vector<Operation>& operations() {
    static const std::vector<Operation> table = {
        {"apply_stiffness", [](Bench& b) { b.backend->apply(b.backend->stiffness(), *b.x, *b.y); },
         nullptr},
        // The product within multigrid: also reads b and the diagonal blocks (not counted).
        {"smooth",
         [](Bench& b) { b.backend->smooth(b.backend->stiffness(), *b.b, *b.x, 1, 0, 0.5, *b.y); },
         nullptr},
        {"internal_force", [](Bench& b) { b.backend->internal_force(*b.x, *b.y); },
         matrix_free_bytes},
        {"block_jacobi",
         [](Bench& b) { b.backend->apply_inverse_diagonal(b.backend->stiffness(), 1, *b.x, *b.y); },
         block_jacobi_bytes},
        // x += a p, r -= a q and r . r: four vectors read, two written.
        {"advance",
         [](Bench& b) {
             b.backend->advance(*b.one, *b.one, *b.one, *b.sums, *b.x, *b.b, *b.y, *b.r,
                                *b.more_sums);
         },
         [](const Sizes& s) { return 6 * s.vector(); }},
        {"turn", [](Bench& b) { b.backend->turn(*b.one, *b.one, *b.x, *b.y); },
         [](const Sizes& s) { return 3 * s.vector(); }},
        {"dot", [](Bench& b) { b.backend->dot(*b.x, *b.y, *b.more_sums); },
         [](const Sizes& s) { return 2 * s.vector(); }},
        // The matrix, written once.
        {"set_stiffness",
         [](Bench& b) {
             std::vector<double> moduli;
             for (const LinearElastic& m : b.model->materials) moduli.push_back(m.stiffness_kpa);
             b.backend->set_stiffness(moduli);
         },
         [](const Sizes& s) { return 9 * s.blocks * s.real; }},
    };
    return table;
}

Bench make_bench(const std::string& name, const BackendOptions& options, const BenchMesh& mesh,
                 Index columns) {
    Bench bench;
    bench.backend = make_backend(name, options);
    bench.model =
        std::make_unique<Model>(renumbered(mesh.model, spatial_order(mesh.model.mesh.nodes)));
    bench.columns = columns;
    bench.backend->prepare(*bench.model);
    const Index rows = bench.model->num_dofs();
    bench.x = bench.backend->make_vector(rows, columns);
    for (auto* vector : {&bench.y, &bench.b, &bench.r}) {
        *vector = bench.backend->make_vector(rows, columns);
        bench.backend->fill(**vector, 0);
    }
    for (auto* sums : {&bench.one, &bench.sums, &bench.more_sums}) {
        *sums = bench.backend->make_sums(columns);
        bench.backend->set(**sums, std::vector<double>(columns, sums == &bench.one ? 1.0 : 0.0));
    }
    std::vector<double> values(static_cast<std::size_t>(rows) * columns);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.37 * double(i));
    bench.backend->copy_in(values, *bench.x);
    return bench;
}

// x . K x must be 2 W for the unconstrained product: checks the answer once before timing.
bool answer_is_right(Bench& bench) {
    const std::size_t columns = static_cast<std::size_t>(bench.columns);
    const std::size_t rows = static_cast<std::size_t>(bench.model->num_dofs());
    std::vector<double> x(rows * columns), force(rows * columns), energy(columns);
    bench.backend->internal_force(*bench.x, *bench.y);
    bench.backend->copy_out(*bench.x, x);
    bench.backend->copy_out(*bench.y, force);
    bench.backend->strain_energy(*bench.x, energy);
    std::vector<double> work(columns, 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) work[i % columns] += x[i] * force[i];
    for (std::size_t c = 0; c < columns; ++c)
        if (!(std::abs(work[c] - 2 * energy[c]) <= 1e-4 * work[c])) return false;
    return true;
}

Sizes sizes_of(const Bench& bench) {
    const Mesh& mesh = bench.model->mesh;
    const bool is_single = bench.backend->describe().precision == Precision::single;
    return {double(mesh.num_nodes()), double(mesh.num_tets()),
            double(node_graph(mesh).items.size()), double(bench.columns), is_single ? 4.0 : 8.0};
}

void add_counters(benchmark::State& state, Bench& bench, double bytes, double seconds) {
    const BackendInfo info = bench.backend->describe();
    const double bandwidth = bytes / seconds;
    const double copy = info.type == "GPU" ? device_copy_bandwidth(*bench.backend, bytes)
                                           : host_copy_bandwidth(bytes);
    state.counters["dofs"] = bench.model->num_dofs();
    state.counters["tets"] = bench.model->mesh.num_tets();
    state.counters["ms_per_column"] = 1e3 * seconds / bench.columns;
    state.counters["elements/s"] = bench.model->mesh.num_tets() * bench.columns / seconds;
    state.counters["MB"] = 1e-6 * bytes;
    state.counters["GB/s"] = 1e-9 * bandwidth;
    state.counters["copy_GB/s"] = 1e-9 * copy;
    state.counters["copy_fraction"] = bandwidth / copy;
    state.SetLabel(info.device);
}

struct Case {
    Operation operation;
    ProductEntry product;
    std::string mesh, backend;
    Precision precision;
    Index columns;
};

void time_case(benchmark::State& state, const Case& c, const std::filesystem::path& folder) {
    BackendOptions options;
    options.product = c.product.product;
    options.precision = c.precision;
    Bench bench = make_bench(c.backend, options, bench_mesh(folder, c.mesh), c.columns);
    if (!answer_is_right(bench)) {
        fail_row(state, "x . K x differs from twice the strain energy.");
        return;
    }
    c.operation.run(bench);
    bench.backend->wait();
    const auto start = std::chrono::steady_clock::now();
    for (auto _ : state) {
        c.operation.run(bench);
        bench.backend->wait();
    }
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    const Bytes bytes = c.operation.bytes ? c.operation.bytes : c.product.bytes;
    add_counters(state, bench, bytes(sizes_of(bench)), time.count() / double(state.iterations()));
}

void run_case(benchmark::State& state, const Case& c, const std::filesystem::path& folder) {
    try {
        time_case(state, c, folder);
    } catch (const std::exception& error) {
        skip_row(state, error);
    }
}

void add_case(const Case& c, const std::filesystem::path& folder) {
    const std::string name = fmt::format(
        "{}/{}/{}/{}/{}/columns:{}", c.operation.name, c.mesh, c.backend, c.product.name,
        c.precision == Precision::single ? "single" : "double", c.columns);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](benchmark::State& state) { run_case(state, c, folder); })
        ->Unit(benchmark::kMicrosecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
}

void add_backend(const std::string& backend, const std::string& mesh,
                 const std::filesystem::path& folder) {
    for (Precision precision : {Precision::single, Precision::double_}) {
        if (backend == "reference" && precision == Precision::single) continue;
        for (const Operation& operation : operations())
            for (const ProductEntry& product : products) {
                if (operation.bytes && product.product != products[0].product) continue;
                for (Index columns : {1, 4, 16, 32})
                    add_case({operation, product, mesh, backend, precision, columns}, folder);
            }
    }
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
    using namespace palpate::bench;
    const std::filesystem::path folder = take_mesh_folder(argc, argv);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    for (const std::string& mesh : bench_mesh_names())
        for (const palpate::BackendEntry& entry : palpate::backend_registry())
            add_backend(entry.name, mesh, folder);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
