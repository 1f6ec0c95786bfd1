// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/pipeline/recover.hpp"

#include <future>
#include <utility>

#include "host/imaging/io.hpp"
#include "host/pipeline/prepared.hpp"

namespace palpate {
namespace {

RecoveryResult recover_target(const PreparedReference& prepared, const TargetState& target,
                              const RecoverOptions& options, StageTimer timer,
                              const ProgressSink& progress) {
    const Recovered found = search_target(prepared, target, options, timer, progress);
    timer.start("volumes");
    report_progress(progress, "volumes", 0, "carrying labels and field to the image grids");
    const LabelledState& reference = prepared.reference.state;
    RecoveryResult result =
        assemble_result(found, reference.regions, reference.field, target.state.regions,
                        target.state.field, options.settings);
    timer.stop();
    result.reference_name = reference.name;
    result.target_name = target.state.name;
    result.linear_solvers = {{"condensing", prepared.mechanics.condensation.solver},
                             {"solving", found.solver}};
    result.timings_s = timer.times_s();
    return result;
}

}  // namespace

Segmentation read_segmentation(const std::filesystem::path& path) {
    return {read_label_image(path), path.filename().string()};
}

void recover_all(const Segmentation& reference, const std::vector<Segmentation>& targets,
                 const RecoverOptions& options, const ResultSink& sink,
                 const ProgressSink& progress) {
    const Settings& settings = options.settings;
    StageTimer timer;
    timer.start("reading");
    report_progress(progress, "reading", 0, "smoothing the segmentations");
    auto reading = std::async(std::launch::async, [&] {
        std::vector<LabelledState> states;
        for (const auto& target : targets) states.push_back(make_state(target, settings));
        return states;
    });
    LabelledState reference_state = make_state(reference, settings);
    std::vector<LabelledState> target_states = reading.get();

    timer.start("surfaces");
    ReferenceState state = make_reference(std::move(reference_state), options, progress);

    timer.start("aligning");
    std::vector<TargetState> aligned;
    for (auto& target : target_states) {
        aligned.push_back(align_target(std::move(target), state, options, progress));
    }

    const PreparedReference prepared =
        prepare_reference(std::move(state), options, timer, progress);
    for (std::size_t k = 0; k < aligned.size(); ++k) {
        sink(k, recover_target(prepared, aligned[k], options, timer, progress));
    }
}

RecoveryResult recover(const Segmentation& reference, const Segmentation& target,
                       const RecoverOptions& options, const ProgressSink& progress) {
    RecoveryResult only;
    recover_all(
        reference, {target}, options,
        [&](std::size_t, RecoveryResult result) { only = std::move(result); }, progress);
    return only;
}

}  // namespace palpate
