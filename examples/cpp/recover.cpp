// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Two segmentations of one patient in, stiffness with its interval and verdict out. The patient is
// a phantom, so that the answer is known.
//
//     build/release/bin/example_recover
#include "host/apps/recover/pipeline/recover.hpp"

#include <fmt/core.h>

#include "host/apps/phantom/pelvis.hpp"

namespace {

using namespace palpate;

int run() {
    LinearSolverOptions solver;
    solver.backend = "reference";  // "opencl", "kokkos": what conjugate gradients run on
    MesherOptions mesher;          // TetGen, in the program palpate-mesh beside this one

    PelvisOptions truth;
    truth.seed = 3;
    truth.stiffness_kpa = 80;
    truth.spacing = Vec3::Constant(2);
    truth.num_nodes = 8000;
    const PelvisPhantom phantom = make_pelvis(truth, solver, mesher);

    // In place of these two: read_segmentation("reference.nii.gz") and
    // read_settings("organs.toml").
    RecoverOptions options;
    options.settings = phantom.settings;
    options.solver = solver;
    options.mesher = mesher;
    options.mesher.num_nodes = 4000;
    const RecoveryResult result =
        recover({phantom.reference, "reference"}, {phantom.target, "target"}, options,
                [](const Progress& step) {
                    if (!step.message.empty())
                        fmt::print(stderr, "{}: {}\n", step.stage, step.message);
                });

    bool holds = true;
    for (const RegionResult& region : result.regions) {
        if (!region.unknown) continue;
        const auto& [low, high] = region.interval_kpa;
        fmt::print("{}: {:.0f} kPa, 95 % interval {:.0f} to {:.0f}, {} ({}); true: {:.0f}\n",
                   region.name, region.stiffness_kpa, low, high, name_of(region.verdict),
                   region.reason, truth.stiffness_kpa);
        holds &= low <= truth.stiffness_kpa && truth.stiffness_kpa <= high;
    }
    return holds ? 0 : 1;
}

}  // namespace

int main() {
    try {
        return run();
    } catch (
        const palpate::Error& error) {  // one sentence and a code, as docs/errors.md lists them
        fmt::print(stderr, "example_recover: {}\n", error.what());
        return 1;
    }
}
