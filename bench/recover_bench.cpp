// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// How long does a user wait, and for what? On pelvis phantoms with 1 mm voxels (2 mm in `small`);
// figures in docs/performance.md.
//   files_to_folder     `palpate recover` on two label volumes, from its start to its end:
//                       the program beside this one, or PALPATE_PROGRAM
//   mesh_to_answer      distance maps of the target, condensing, response model, search, full solve
//   further_target      distances to search to full solve, the reference being prepared
//   voxels_to_answer    label volumes in memory to the whole result
//   nested_baseline     the published search from the same mesh, without any condensing, until it
//                       stops or `nested_limit_s` have passed
#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/child_program.hpp"
#include "host/apps/phantom/pelvis.hpp"
#include "host/apps/recover/pipeline/recover.hpp"
#include "host/apps/recover/pipeline/search_target.hpp"
#include "host/io/files.hpp"
#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/base/large_blocks.hpp"

namespace palpate {
namespace {

struct Size {
    const char* name;
    Index truth_nodes, nodes;
    double spacing_mm;
};
constexpr Size sizes[] = {{"small", 3000, 1200, 2.0}, {"seed_size", 30000, 6000, 1.0}};
constexpr unsigned seed = 3;
constexpr double true_kpa = 90;
constexpr double nested_limit_s = 300;

// A folder with the files of a phantom as `palpate phantom` writes them.
class PhantomFiles {
public:
    explicit PhantomFiles(const Size& size) {
        const std::string voxel = fmt::format("{}", size.spacing_mm);
        const auto made = bench::run_program(
            {bench::palpate_program(), "phantom", "pelvis", "--quiet", "--seed",
             fmt::format("{}", seed), "--stiffness-kpa", fmt::format("{}", true_kpa), "--spacing",
             voxel, voxel, voxel, "--nodes", fmt::format("{}", size.truth_nodes), "--out",
             phantom().string()});
        if (made.exit_code != 0)
            throw Error(ErrorCode::internal,
                        fmt::format("palpate phantom ended with {}", made.exit_code));
    }
    std::filesystem::path phantom() const { return folder_.path() / "phantom"; }
    std::filesystem::path result() const { return folder_.path() / "result"; }

private:
    PrivateFolder folder_;
};

/// A phantom with everything that stands before the timed part.
struct Case {
    RecoverOptions options;
    Segmentation reference, target;
    PreparedReference prepared;
    TargetState aligned;
};

RecoverOptions recover_options(const PelvisPhantom& phantom, Index nodes) {
    RecoverOptions options;
    options.settings = phantom.settings;
    options.mesher.num_nodes = nodes;
    options.solver.backend = backend_registry().front().name;
    return options;
}

Case make_case(const Size& size) {
    PelvisOptions pelvis;
    pelvis.seed = seed;
    pelvis.stiffness_kpa = true_kpa;
    pelvis.num_nodes = size.truth_nodes;
    pelvis.spacing = Vec3::Constant(size.spacing_mm);
    LinearSolverOptions solver;
    solver.backend = backend_registry().front().name;
    const PelvisPhantom phantom = make_pelvis(pelvis, solver, {});
    RecoverOptions options = recover_options(phantom, size.nodes);
    Segmentation reference{phantom.reference, "reference"}, target{phantom.target, "target"};
    ReferenceState state = make_reference(make_state(reference, options.settings), options, {});
    TargetState aligned = align_target(make_state(target, options.settings), state, options, {});
    StageTimer timer;
    PreparedReference prepared = prepare_reference(std::move(state), options, timer, {});
    return {std::move(options), std::move(reference), std::move(target), std::move(prepared),
            std::move(aligned)};
}

const Case& case_of(const Size& size) {
    static std::map<std::string, Case> cases;
    const auto found = cases.find(size.name);
    return found != cases.end() ? found->second
                                : cases.emplace(size.name, make_case(size)).first->second;
}

void report(benchmark::State& state, const Recovered& found) {
    const double kpa = std::exp(found.estimate.theta[0]);
    state.counters["kpa"] = kpa;
    state.counters["error_percent"] = 100 * (kpa / true_kpa - 1);
    state.counters["low_kpa"] = found.estimate.interval_kpa[0][0];
    state.counters["high_kpa"] = found.estimate.interval_kpa[0][1];
    state.counters["iterations"] = found.estimate.termination.iterations;
    state.counters["tets"] = found.recovery.model.mesh.num_elements();
    state.counters["surface_dofs"] =
        3.0 * static_cast<double>(found.recovery.driven.size() + found.recovery.observed.size());
}

void add_times(benchmark::State& state, const StageTimer& timer) {
    for (const auto& [stage, seconds] : timer.times_s()) state.counters[stage + "_s"] = seconds;
}

double megabytes_in(const std::filesystem::path& folder) {
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) bytes += entry.file_size();
    return 1e-6 * static_cast<double>(bytes);
}

void files_to_folder(benchmark::State& state, const Size& size) {
    const PhantomFiles files(size);
    bench::ProgramRun run{};
    for (auto _ : state) {
        state.PauseTiming();
        std::filesystem::remove_all(files.result());
        state.ResumeTiming();
        run =
            bench::run_program({bench::palpate_program(), "recover", "--quiet", "--nodes",
                                fmt::format("{}", size.nodes), files.phantom() / "reference.nii.gz",
                                files.phantom() / "target.nii.gz", "--config",
                                files.phantom() / "organs.toml", "--out", files.result()});
        if (run.exit_code != 0)
            throw Error(ErrorCode::internal,
                        fmt::format("palpate recover ended with {}", run.exit_code));
    }
    state.counters["processor_s"] = run.processor_s;
    state.counters["peak_memory_mib"] = run.peak_memory_mib;
    state.counters["folder_mb"] = megabytes_in(files.result());
    std::ifstream text(files.result() / "result.json");
    const auto result = nlohmann::json::parse(text);
    for (const auto& [stage, duration] : result.at("timings_s").items())
        state.counters[stage + "_s"] = duration.get<double>();
}

void mesh_to_answer(benchmark::State& state, const Size& size) {
    const Case& input = case_of(size);
    Recovered found;
    for (auto _ : state) {
        StageTimer timer;
        auto shapes = start_target_shapes(input.aligned, input.options.settings);
        const PreparedReference prepared =
            prepare_reference(input.prepared.reference, input.prepared.mesh, input.prepared.mesher,
                              input.prepared.maps, input.options, timer, {});
        found = search_target(prepared, input.aligned, std::move(shapes), input.options, timer, {});
        timer.stop();
        add_times(state, timer);
    }
    report(state, found);
}

void further_target(benchmark::State& state, const Size& size) {
    const Case& input = case_of(size);
    Recovered found;
    for (auto _ : state) {
        StageTimer timer;
        found = search_target(input.prepared, input.aligned,
                              start_target_shapes(input.aligned, input.options.settings),
                              input.options, timer, {});
        timer.stop();
        add_times(state, timer);
    }
    report(state, found);
}

void voxels_to_answer(benchmark::State& state, const Size& size) {
    const Case& input = case_of(size);
    for (auto _ : state) {
        const RecoveryResult result = recover(input.reference, input.target, input.options);
        for (const auto& [stage, seconds] : result.timings_s) {
            state.counters[stage + "_s"] = seconds;
        }
    }
}

void nested_baseline(benchmark::State& state, const Size& size) {
    const Case& input = case_of(size);
    RecoverOptions options = input.options;
    options.method = SearchMethod::nested_lbfgs;
    options.nested.time_limit_s = nested_limit_s;
    Recovered found;
    for (auto _ : state) {
        StageTimer timer;
        found =
            search_target(input.prepared, input.aligned,
                          start_target_shapes(input.aligned, options.settings), options, timer, {});
        timer.stop();
        add_times(state, timer);
    }
    const double kpa = std::exp(found.estimate.theta[0]);
    state.counters["kpa"] = kpa;
    state.counters["error_percent"] = 100 * (kpa / true_kpa - 1);
    state.counters["converged"] = found.estimate.termination.converged;
}

using Body = void (*)(benchmark::State&, const Size&);

void run_checked(benchmark::State& state, Body body, const Size& size) {
    try {
        body(state, size);
    } catch (const Error& error) {
        state.SkipWithError(fmt::format("failed: {}", error.what()).c_str());
    }
}

void register_all() {
    const std::pair<const char*, Body> bodies[] = {{"files_to_folder", files_to_folder},
                                                   {"mesh_to_answer", mesh_to_answer},
                                                   {"further_target", further_target},
                                                   {"voxels_to_answer", voxels_to_answer},
                                                   {"nested_baseline", nested_baseline}};
    for (const Size& size : sizes) {
        for (const auto& [name, body] : bodies) {
            benchmark::RegisterBenchmark(
                fmt::format("{}/{}", name, size.name).c_str(),
                [body = body, &size](benchmark::State& state) { run_checked(state, body, size); })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
        }
    }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    palpate::keep_large_blocks();
    palpate::register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
