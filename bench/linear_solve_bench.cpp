// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// How long does one linear solve to 1e-8 take: every back end x cubes per edge x columns?
#include <benchmark/benchmark.h>

#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/linear_solver.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

Columns free_forces(const Model& model, Index columns) {
    Columns b = fixtures::random_columns(model.num_dofs(), columns, 1);
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) b.row(d).setZero();
    return b;
}

/// Set-up (assembly, factorisation or kernel build) is outside the timing; its seconds and those of
/// the first solve are in `linear_setup`.
void linear_solve(benchmark::State& state, const std::string& backend) {
    const Index cubes = static_cast<Index>(state.range(0));
    const Index columns = static_cast<Index>(state.range(1));
    const Model model = fixtures::two_tissue_model({cubes, cubes, cubes});
    LinearSolverOptions options;
    options.backend = backend;
    options.method = backend == "reference" ? LinearMethod::direct : LinearMethod::jacobi;
    LinearSolverSummary summary;
    try {
        const auto solver = make_linear_solver(model, options);
        const Columns b = free_forces(model, columns);
        Columns x;
        solver->solve(b, x);  // checks the answer, and warms up the kernels
        for (auto _ : state) {
            x.resize(0, 0);
            summary = solver->solve(b, x);
        }
    } catch (const Error& error) {
        state.SkipWithError(error.what());
        return;
    }
    if (!summary.converged) state.SkipWithError(summary.message.c_str());
    state.counters["dofs"] = model.num_dofs();
    state.counters["iterations"] = summary.iterations;
    state.counters["residual"] = summary.relative_residual;
    state.counters["seconds_per_column"] = benchmark::Counter(
        static_cast<double>(columns),
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void linear_setup(benchmark::State& state, const std::string& backend) {
    const Index cubes = static_cast<Index>(state.range(0));
    const Model model = fixtures::two_tissue_model({cubes, cubes, cubes});
    LinearSolverOptions options;
    options.backend = backend;
    options.method = backend == "reference" ? LinearMethod::direct : LinearMethod::jacobi;
    try {
        for (auto _ : state) benchmark::DoNotOptimize(make_linear_solver(model, options));
    } catch (const Error& error) {
        state.SkipWithError(error.what());
    }
    state.counters["dofs"] = model.num_dofs();
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    for (const palpate::BackendEntry& entry : palpate::backend_registry()) {
        benchmark::RegisterBenchmark(("linear_solve/" + entry.name).c_str(), palpate::linear_solve,
                                     entry.name)
            ->ArgNames({"cubes", "columns"})
            ->ArgsProduct({{6, 12, 18}, {1, 16, 32}})
            ->UseRealTime()
            ->Unit(benchmark::kMillisecond);
        benchmark::RegisterBenchmark(("linear_setup/" + entry.name).c_str(), palpate::linear_setup,
                                     entry.name)
            ->ArgNames({"cubes"})
            ->Arg(6)
            ->Arg(12)
            ->Arg(18)
            ->UseRealTime()
            ->Unit(benchmark::kMillisecond);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
