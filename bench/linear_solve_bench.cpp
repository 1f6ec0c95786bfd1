// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// How long does it take to solve K x = b to 1e-8: every mesh x columns x solver, ours and peers on
// the same matrix? Row names are what / mesh / solver / columns:
//   set_up            until the solver can take right-hand sides; peers find K assembled, ours not
//   solve             one call for all columns, after one that was not timed
//   set_up_and_solve  both on a fresh solver, once; counters set_up_s and solve_s are its parts
// Counters: dofs; iterations, the mean per column; residual, the largest relative residual,
// computed here in fp64 from the elements; before_MiB and peak_MiB, resident memory of the process
// before set-up (mesh, right-hand sides and, for peers, K among it) and at most.
//
//   linear_solve_bench --meshes=FOLDER --benchmark_filter='/pelvis_90k/.*/columns:16'
//                      --benchmark_repetitions=5 --benchmark_out=rows.json
//   mpirun -n 2 linear_solve_bench ...    PETSc alone, on two cores
// PALPATE_BENCH_MEMORY_GIB makes solvers that need more fail; --benchmark_filter=-cholmod skips
// one.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "bench/contenders.hpp"
#include "bench/peers/peer.hpp"
#include "bench/process_memory.hpp"
#include "bench/row_error.hpp"
#include "solver/base/error.hpp"
#include "solver/base/large_blocks.hpp"

namespace palpate::bench {
namespace {

// Solvers judge by a residual that they update rather than compute: allow it to drift a little.
constexpr double largest_residual = 2 * relative_tolerance;

enum class Row { set_up, solve, set_up_and_solve };

const char* name_of(Row row) {
    return row == Row::set_up ? "set_up" : row == Row::solve ? "solve" : "set_up_and_solve";
}

/// One problem is kept at a time.
const LinearProblem& problem_of(const BenchMesh& mesh, Index columns) {
    static LinearProblem current;
    static std::string name;
    if (name == mesh.name && current.b.cols() == columns) return current;
    current = {};
    current = make_linear_problem(mesh, columns);
    name = mesh.name;
    return current;
}

template <typename Work>
double seconds_of(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Case {
    Row row;
    std::string mesh;
    ContenderEntry solver;
    Index columns;
};

void add_counters(benchmark::State& state, const Case& c, const BenchMesh& mesh,
                  const LinearProblem& problem, const Contender& contender, double iterations) {
    state.counters["peak_MiB"] = peak_memory_mib();  // before the check takes memory itself
    state.counters["dofs"] = mesh.model.num_dofs();
    state.SetLabel(contender.describe());
    if (c.row == Row::set_up) return;
    const double residual = relative_residual(mesh.model, problem, contender.answer());
    state.counters["iterations"] = iterations;
    state.counters["residual"] = residual;
    if (!(residual <= largest_residual))
        fail_row(state, fmt::format("The relative residual is {:.2g}.", residual));
}

void time_rows(benchmark::State& state, const Case& c, const BenchMesh& mesh) {
    const LinearProblem& problem = problem_of(mesh, c.columns);
    std::unique_ptr<Contender> contender = c.solver.make(mesh, problem);
    reset_peak_memory();
    state.counters["before_MiB"] = memory_mib();
    if (c.row == Row::solve) {
        contender->set_up();
        contender->solve();
    }
    double set_up_s = 0, solve_s = 0, iterations = 0;
    bool is_used = false;
    for (auto _ : state) {
        if (is_used && c.row != Row::solve) {
            contender.reset();  // two of them would show in the peak
            contender = c.solver.make(mesh, problem);
        }
        is_used = true;
        const double first = c.row == Row::solve ? 0 : seconds_of([&] { contender->set_up(); });
        const double then =
            c.row == Row::set_up ? 0 : seconds_of([&] { iterations = contender->solve(); });
        state.SetIterationTime(first + then);
        set_up_s += first;
        solve_s += then;
    }
    if (c.row == Row::set_up_and_solve) {
        state.counters["set_up_s"] = {set_up_s, benchmark::Counter::kAvgIterations};
        state.counters["solve_s"] = {solve_s, benchmark::Counter::kAvgIterations};
    }
    add_counters(state, c, mesh, problem, *contender, iterations);
}

void run_case(benchmark::State& state, const Case& c, const std::filesystem::path& folder) {
    try {
        const BenchMesh& mesh = bench_mesh(folder, c.mesh);
        if (c.solver.most_dofs > 0 && mesh.model.num_dofs() > c.solver.most_dofs)
            throw Error(ErrorCode::unsupported,
                        fmt::format("{} is not run above {} degrees of freedom.", c.solver.name,
                                    c.solver.most_dofs));
        time_rows(state, c, mesh);
    } catch (const std::exception& error) {
        skip_row(state, error);
    }
}

void add_case(const Case& c, const std::filesystem::path& folder, const ParallelRun& run) {
    std::string name = fmt::format("{}/{}/{}", name_of(c.row), c.mesh, c.solver.name);
    if (c.row != Row::set_up) name += fmt::format("/columns:{}", c.columns);
    auto* registered = benchmark::RegisterBenchmark(
        name.c_str(), [=](benchmark::State& state) { run_case(state, c, folder); });
    registered->UseManualTime()->Unit(benchmark::kMillisecond);
    // Processes that share work must agree on the number of iterations.
    if (run.size > 1) registered->Iterations(1);
}

void add_all(const std::filesystem::path& folder, const ParallelRun& run) {
    for (const std::string& mesh : bench_mesh_names())
        for (const ContenderEntry& solver : contenders()) {
            if (run.size > 1 && !solver.shares_work_among_processes) continue;
            add_case({Row::set_up, mesh, solver, 1}, folder, run);
            for (Index columns : {1, 16, 32})
                for (Row row : {Row::solve, Row::set_up_and_solve})
                    add_case({row, mesh, solver, columns}, folder, run);
        }
}

/// For the processes of a parallel run whose results the first one reports.
class SilentReporter final : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>&) override {}
};

/// Leaves the file of results to the first process.
void drop_output_file(int& argc, char** argv) {
    const auto names_output = [](const char* argument) {
        return std::string_view(argument).starts_with("--benchmark_out");
    };
    argc = static_cast<int>(std::remove_if(argv + 1, argv + argc, names_output) - argv);
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
    using namespace palpate::bench;
    palpate::keep_large_blocks();  // for all contenders, as the command line does
    const std::filesystem::path folder = take_mesh_folder(argc, argv);
    const ParallelRun run = parallel_run();
    if (run.rank > 0) drop_output_file(argc, argv);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    add_all(folder, run);
    SilentReporter silent;
    if (run.rank > 0)
        benchmark::RunSpecifiedBenchmarks(&silent);
    else
        benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
