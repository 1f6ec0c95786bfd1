// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// How long does one iteration's work take on each back end? Names are
// operation / back end / product / precision, arguments cubes per edge and columns.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

/// A back end with a prepared box and two vectors.
struct Bench {
    std::unique_ptr<Backend> backend;
    Model model;
    std::unique_ptr<DeviceVector> x, y;
    Index columns = 1;

    std::vector<double> coefficients(double value) const {
        return std::vector<double>(columns, value);
    }
};

Bench make_bench(const std::string& name, const BackendOptions& options, Index cubes,
                 Index columns) {
    Bench bench;
    bench.backend = make_backend(name, options);
    bench.model = fixtures::two_tissue_model({cubes, cubes, cubes});
    bench.columns = columns;
    bench.backend->prepare(bench.model);
    bench.x = bench.backend->make_vector(bench.model.num_dofs(), columns);
    bench.y = bench.backend->make_vector(bench.model.num_dofs(), columns);
    std::vector<double> values(static_cast<std::size_t>(bench.model.num_dofs()) * columns);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.37 * i);
    bench.backend->copy_in(values, *bench.x);
    bench.backend->fill(*bench.y, 0);
    return bench;
}

// x . K x must be 2 W for the unconstrained product: checks the answer once before timing.
bool answer_is_right(Bench& bench) {
    std::vector<double> work(bench.columns), energy(bench.columns);
    bench.backend->internal_force(*bench.x, *bench.y);
    bench.backend->dot(*bench.x, *bench.y, work);
    bench.backend->strain_energy(*bench.x, energy);
    for (Index c = 0; c < bench.columns; ++c)
        if (!(std::abs(work[c] - 2 * energy[c]) <= 1e-4 * work[c])) return false;
    return true;
}

using Operation = std::function<void(Bench&)>;

void measure(benchmark::State& state, const std::string& name, const BackendOptions& options,
             const Operation& operation) {
    Bench bench;
    try {
        bench = make_bench(name, options, static_cast<Index>(state.range(0)),
                           static_cast<Index>(state.range(1)));
    } catch (const Error& error) {
        state.SkipWithError(error.what());
        return;
    }
    if (!answer_is_right(bench)) {
        state.SkipWithError("x . K x differs from twice the strain energy.");
        return;
    }
    operation(bench);
    bench.backend->wait();
    for (auto _ : state) {
        operation(bench);
        bench.backend->wait();
    }
    const double columns = bench.columns;
    state.counters["dofs"] = bench.model.num_dofs();
    state.counters["tets"] = bench.model.mesh.num_tets();
    state.counters["ms_per_column"] =
        benchmark::Counter(1e-3 * columns, benchmark::Counter::kIsIterationInvariantRate |
                                               benchmark::Counter::kInvert);
    state.counters["elements/s"] = benchmark::Counter(
        bench.model.mesh.num_tets() * columns, benchmark::Counter::kIsIterationInvariantRate);
}

void add(const std::string& operation_name, const std::string& backend, Product product,
         Precision precision, const Operation& operation) {
    BackendOptions options;
    options.product = product;
    options.precision = precision;
    const std::string name =
        fmt::format("{}/{}/{}/{}", operation_name, backend,
                    product == Product::assembled ? "assembled" : "matrix_free",
                    precision == Precision::single ? "single" : "double");
    auto* registered = benchmark::RegisterBenchmark(
        name.c_str(), [=](benchmark::State& s) { measure(s, backend, options, operation); });
    // 17 cubes per edge: 5,832 nodes, 29,478 tets; 4 is for CI, so that this never rots.
    registered->ArgNames({"cubes", "columns"})
        ->Unit(benchmark::kMicrosecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
    for (int cubes : {4, 17})
        for (int columns : {1, 4, 16, 32}) registered->Args({cubes, columns});
}

void add_all() {
    const Operation apply = [](Bench& b) { b.backend->apply_stiffness(*b.x, *b.y); };
    const Operation force = [](Bench& b) { b.backend->internal_force(*b.x, *b.y); };
    const Operation jacobi = [](Bench& b) { b.backend->apply_block_jacobi(*b.x, *b.y); };
    const Operation axpby = [](Bench& b) {
        b.backend->axpby(b.coefficients(0.5), *b.x, b.coefficients(0.5), *b.y);
    };
    const Operation dot = [](Bench& b) {
        std::vector<double> result(b.columns);
        b.backend->dot(*b.x, *b.y, result);
        benchmark::DoNotOptimize(result.data());
    };
    const Operation stiffness = [](Bench& b) {
        std::vector<double> moduli;
        for (const LinearElastic& m : b.model.materials) moduli.push_back(m.stiffness_kpa);
        b.backend->set_stiffness(moduli);
    };
    for (const BackendEntry& entry : backend_registry()) {
        const bool is_reference = entry.name == "reference";
        for (Precision precision : {Precision::single, Precision::double_}) {
            if (is_reference && precision == Precision::single) continue;
            for (Product product : {Product::assembled, Product::matrix_free})
                add("apply_stiffness", entry.name, product, precision, apply);
            add("internal_force", entry.name, Product::assembled, precision, force);
            add("block_jacobi", entry.name, Product::assembled, precision, jacobi);
            add("axpby", entry.name, Product::assembled, precision, axpby);
            add("dot", entry.name, Product::assembled, precision, dot);
            add("set_stiffness", entry.name, Product::assembled, precision, stiffness);
        }
    }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    palpate::add_all();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
