// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// How long does equilibrium at large deformation take? A box of 35k tetrahedra, neo-Hookean with a
// stiff inclusion, compressed by 10 % between plates that hold it. Figures in docs/performance.md.
//   tangent      assembling the stiffness once
//   equilibrium  from rest to the full load
//   gradient     of a sum of displacements by every parameter, force and prescribed displacement
// direct: with a factorisation; multigrid, jacobi: with conjugate gradients on each back end, fp32.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>
#include <vector>

#include "bench/solid_problem.hpp"
#include "solver/adjoint/solid_adjoint.hpp"
#include "solver/backend/registry.hpp"
#include "solver/equilibrium/newton.hpp"

namespace palpate {
namespace {

using bench::compressed_box;
using Size = bench::SolidSize;
constexpr Size sizes[] = {bench::small_solid, bench::seed_size_solid, bench::large_solid,
                          bench::quadratic_solid};

void tangent(benchmark::State& state, const Size& size) {
    const auto work = compressed_box(size);
    const SolidAssembly solid(work.model);
    BlockMatrix matrix = solid.make_matrix();
    const Eigen::VectorXd u = Eigen::VectorXd::Zero(work.model.num_dofs());
    for (auto _ : state) solid.tangent(u, matrix);
}

void equilibrium(benchmark::State& state, const Size& size, const MatrixSolverOptions& linear) {
    const auto work = compressed_box(size);
    EquilibriumOptions options;
    options.linear = linear;
    for (auto _ : state) {
        const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, options);
        if (!found.converged) state.SkipWithError(found.message.c_str());
        state.counters["newton_steps"] = static_cast<double>(found.records.size());
        state.counters["relative_residual"] = found.relative_residual;
    }
    state.counters["dofs"] = work.model.num_dofs();
}

void gradient(benchmark::State& state, const Size& size, const MatrixSolverOptions& linear) {
    const auto work = compressed_box(size);
    const SolidAssembly solid(work.model);
    const Eigen::VectorXd slope = Eigen::VectorXd::Ones(work.model.num_dofs());
    EquilibriumOptions options;
    options.linear = linear;
    for (auto _ : state) {
        state.PauseTiming();
        const Equilibrium found = solve_equilibrium(solid, work.loads, options);
        state.ResumeTiming();
        benchmark::DoNotOptimize(solid_gradient(solid, found, slope).force.sum());
    }
}

/// With a factorisation, and with conjugate gradients on each back end.
std::vector<std::pair<std::string, MatrixSolverOptions>> solvers() {
    std::vector<std::pair<std::string, MatrixSolverOptions>> list{{"direct", {}}};
    for (const BackendEntry& entry : backend_registry())
        for (const LinearMethod method : {LinearMethod::multigrid, LinearMethod::jacobi})
            if (entry.name != "reference")
                list.push_back({entry.name + "/" + name_of(method),
                                {.method = method, .backend = entry.name}});
    return list;
}

template <typename Run, typename... Options>
void add(const std::string& name, Run run, const Options&... options) {
    for (const Size& size : sizes)
        benchmark::RegisterBenchmark((name + "/" + size.name).c_str(), run, size, options...)
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    palpate::add("tangent", palpate::tangent);
    for (const auto& [name, linear] : palpate::solvers()) {
        palpate::add("equilibrium/" + name, palpate::equilibrium, linear);
        palpate::add("gradient/" + name, palpate::gradient, linear);
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
