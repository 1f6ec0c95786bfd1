// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/recover.hpp"

#include <fmt/core.h>

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "host/apps/recover/pipeline/assemble_result.hpp"
#include "host/apps/recover/pipeline/joint_estimate.hpp"
#include "host/apps/recover/pipeline/landmarks.hpp"
#include "host/apps/recover/pipeline/partial_target.hpp"
#include "host/apps/recover/pipeline/poisson_ratios.hpp"
#include "host/apps/recover/pipeline/saved_reference_file.hpp"
#include "host/apps/recover/pipeline/search_target.hpp"

namespace palpate {
namespace {

/// Whether it is of the run, not of one target: the mesher, which has a limit of its own, is done.
bool ends_all(const Error& error) {
    return error.code() == ErrorCode::cancelled || error.code() == ErrorCode::time_limit;
}

void add_warnings(const char* which, const LabelledState& state, RecoveryResult& result) {
    for (const std::string& warning : state.warnings)
        result.warnings.push_back(fmt::format("{}: {}", which, warning));
}

RecoveryResult recover_target(const PreparedReference& prepared, TargetState& target,
                              std::future<TargetShapes> shapes, const RecoverOptions& options,
                              StageTimer timer, JointTarget& joint, const ProgressSink& progress) {
    const Recovered found =
        search_target(prepared, target, std::move(shapes), options, timer, progress);
    joint = joint_target(found.estimate, options.settings);
    target.alignment = found.alignment;
    timer.start("volumes");
    report_progress(progress, "volumes", 0, "carrying labels and field to the image grids");
    const LabelledState& reference = prepared.reference.state;
    RecoveryResult result = assemble_result(found, reference, target, options.settings);
    result.landmarks = measure_landmarks(options.landmarks, result.displacement_field,
                                         target.alignment.reference_to_target);
    timer.stop();
    add_warnings("Reference", reference, result);
    if (target.labels) add_warnings("Target", *target.labels, result);
    result.reference_name = reference.name;
    result.target_name = target.name;
    const LinearSolverInfo& condensing = prepared.mechanics.condensation.solver;
    if (!condensing.reason.empty()) result.linear_solvers.push_back({"condensing", condensing});
    result.linear_solvers.push_back({"solving", found.solver});
    if (found.finite) result.element_loops = found.finite->loops;
    result.timings_s = timer.times_s();
    return result;
}

std::optional<SavedReference> read_saved(const RecoverOptions& options,
                                         const ProgressSink& progress) {
    if (options.load_reduced.empty()) return std::nullopt;
    report_progress(progress, "reading", 0, options.load_reduced.filename().string());
    return read_saved_reference(options.load_reduced);
}

/// A target before it is searched: where it stands among those that were asked for, or the error
/// that ends it.
template <class State>
struct Ready {
    std::size_t number = 0;
    std::optional<State> state = std::nullopt;
    std::optional<Error> error = std::nullopt;
};

/// `make` for target `number`; its error is kept where `tell` wants to go on without that target.
template <class Make>
auto made_ready(std::size_t number, const TargetSinks& tell, const Make& make) {
    Ready<decltype(make())> ready{number};
    try {
        ready.state = make();
    } catch (const Error& error) {
        if (!tell.goes_on_without || ends_all(error)) throw;
        ready.error = error;
    }
    return ready;
}

using ReadyLabels = std::vector<Ready<LabelledState>>;
using ReadyTargets = std::vector<Ready<TargetState>>;

ReadyLabels make_states(const std::vector<Segmentation>& targets, const Settings& settings,
                        const TargetSinks& tell) {
    ReadyLabels states;
    for (std::size_t k = 0; k < targets.size(); ++k)
        states.push_back(made_ready(k, tell, [&] { return make_state(targets[k], settings); }));
    return states;
}

/// Gives one target after the other, in the frame of the reference; empty after the last.
using NextTarget = std::unique_ptr<Ready<TargetState>>;
using TargetStream = std::function<NextTarget(const ReferenceState& reference)>;

/// The next that can be searched; those that cannot are told of.
NextTarget next_ready(const TargetStream& targets, const ReferenceState& reference,
                      const TargetSinks& tell) {
    for (;;) {
        NextTarget next = targets(reference);
        if (!next || !next->error) return next;
        tell.failed(next->number, *next->error);
    }
}

/// The reference, as far as the alignment needs it: with its surfaces, or as it was saved.
ReferenceState start_reference(LabelledState state, const std::optional<SavedReference>& saved,
                               const RecoverOptions& options, StageTimer& timer,
                               const ProgressSink& progress) {
    if (saved) {
        check_same_reference(*saved, state, options.settings);
        return reference_state(*saved, std::move(state));
    }
    timer.start("surfaces");
    return make_reference(std::move(state), options, progress);
}

PreparedReference finish_reference(ReferenceState state, std::optional<SavedReference> saved,
                                   const RecoverOptions& options, StageTimer& timer,
                                   const ProgressSink& progress) {
    if (!saved) return prepare_reference(std::move(state), options, timer, progress);
    timer.start("loading");
    const std::string name = saved->name;
    PreparedReference prepared = restore(std::move(*saved), std::move(state), options);
    prepared.mechanics.condensation.solver.reason += ", read from a saved reduced model";
    const Mechanics& mechanics = prepared.mechanics;
    report_progress(
        progress, "loading", 1,
        fmt::format("{}: {} nodes, {} elements, {} wall motions, {} surface modes", name,
                    prepared.mesh.mesh.num_nodes(), prepared.mesh.mesh.num_elements(),
                    mechanics.response.num_functionals(), mechanics.response.num_modes()));
    return prepared;
}

void save(const PreparedReference& prepared, const RecoverOptions& options, StageTimer& timer,
          const ProgressSink& progress) {
    if (options.save_reduced.empty()) return;
    timer.start("saving");
    report_progress(progress, "saving", 0, options.save_reduced.filename().string());
    write_saved_reference(saved_form(prepared, options.settings), options.save_reduced);
}

/// Of the stages of `result` that follow those of `shared`.
double seconds_after(const StageTimer& shared, const RecoveryResult& result) {
    double sum = 0;
    for (std::size_t k = shared.times_s().size(); k < result.timings_s.size(); ++k) {
        sum += result.timings_s[k].second;
    }
    return sum;
}

/// Whether what targets leave can be put together: mechanics that are the same for all.
bool can_join(const RecoverOptions& options, const Mechanics& mechanics) {
    return options.method == SearchMethod::map && options.law.is_linear() &&
           mechanics.recovery.unknown_ratio.empty();
}

/// Those of several targets that a joint estimate is made of.
struct JointTargets {
    std::vector<JointTarget> searched;
    JointResult result;  ///< who was left out

    void add(std::size_t k, JointTarget target, bool converged, const std::string& repeats) {
        if (!repeats.empty()) {
            result.left_out.emplace_back(k, repeats);
        } else if (!converged) {
            result.left_out.emplace_back(k, "did not converge");
        } else if (!target.told_alone.empty()) {
            result.left_out.emplace_back(k, target.told_alone);
        } else {
            searched.push_back(std::move(target));
        }
    }
};

void join(JointTargets targets, const RecoverOptions& options, const JointSink& tell,
          const ProgressSink& progress) {
    JointResult result = std::move(targets.result);
    result.num_targets = targets.searched.size();
    StageTimer timer;
    timer.start("joint");
    try {
        result.regions =
            joint_estimate(targets.searched, options.settings, options.search, progress);
    } catch (const Error& error) {
        if (ends_all(error)) throw;
        result.failure = error.what();
    }
    timer.stop();
    result.seconds = timer.times_s()[0].second;
    if (!result.regions.empty() || !result.failure.empty()) tell(std::move(result));
}

/// Of each target: what its labels are a copy of; empty: of nothing that came before.
std::vector<std::string> repetitions(const Segmentation& reference,
                                     const std::vector<Segmentation>& targets) {
    std::vector<std::string> found(targets.size());
    for (std::size_t k = 0; k < targets.size(); ++k) {
        if (is_same(reference, targets[k])) found[k] = "has the labels of the reference";
        for (std::size_t other = 0; other < k && found[k].empty(); ++other)
            if (is_same(targets[other], targets[k]))
                found[k] = fmt::format("has the labels of target {}", other + 1);
    }
    return found;
}

void check_options(const RecoverOptions& options) {
    check_unknown_ratios(options);
    check_tissue_law(options);
    if (options.method == SearchMethod::nested_lbfgs && options.element != ElementType::tet4)
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("--method nested-lbfgs takes tet4, not {}; use --method map",
                                element_table(options.element).name));
}

/// Targets that are brought into the frame of the reference all at once, when the first is asked
/// for: one that does not fit is told early.
TargetStream all_at_once(std::function<ReadyTargets(const ReferenceState& reference)> align) {
    auto aligned = std::make_shared<std::optional<ReadyTargets>>();
    auto at = std::make_shared<std::size_t>(0);
    return [align = std::move(align), aligned, at](const ReferenceState& reference) {
        if (!*aligned) *aligned = align(reference);
        NextTarget next;
        if (*at < (*aligned)->size())
            next = std::make_unique<Ready<TargetState>>(std::move((**aligned)[(*at)++]));
        return next;
    };
}

void recover_aligned(LabelledState reference, std::optional<SavedReference> saved,
                     const TargetStream& targets, const std::vector<std::string>& repeats,
                     const RecoverOptions& options, StageTimer& timer, const TargetSinks& tell,
                     const ProgressSink& progress) {
    ReferenceState state = start_reference(std::move(reference), saved, options, timer, progress);
    timer.start("aligning");
    NextTarget ahead = next_ready(targets, state, tell);
    if (!ahead) return;
    std::future<TargetShapes> next = start_target_shapes(*ahead->state, options.settings);
    const PreparedReference prepared =
        finish_reference(std::move(state), std::move(saved), options, timer, progress);
    save(prepared, options, timer, progress);
    timer.stop();
    if (tell.prepared) tell.prepared(prepared.mesh);

    JointTargets together;
    while (ahead) {
        const NextTarget now = std::move(ahead);  // its shapes are being made from where it lies
        const std::size_t k = now->number;
        TargetState& target = *now->state;
        if (tell.started) tell.started(k);
        if (repeats.size() > 1) {
            report_progress(progress, fmt::format("target {}", k + 1), 0,
                            fmt::format("of {}: {}", repeats.size(), target.name));
        }
        std::future<TargetShapes> shapes = std::move(next);
        ahead = next_ready(targets, prepared.reference, tell);
        if (ahead) next = start_target_shapes(*ahead->state, options.settings);
        try {
            JointTarget joint;
            RecoveryResult result = recover_target(prepared, target, std::move(shapes), options,
                                                   timer, joint, progress);
            const bool converged = result.termination.converged;
            const double seconds = seconds_after(timer, result);
            tell.result(k, std::move(result), seconds);
            // What a joint estimate needs of a target takes some 100 MB: kept only for one.
            if (tell.joint && joint.problem)
                together.add(k, std::move(joint), converged, repeats[k]);
        } catch (const Error& error) {
            if (!tell.failed || ends_all(error)) throw;
            tell.failed(k, error);
        }
    }
    if (tell.joint && together.searched.size() > 1 && can_join(options, prepared.mechanics))
        join(std::move(together), options, tell.joint, progress);
}

}  // namespace

void recover_all(const Segmentation& reference, const std::vector<Segmentation>& targets,
                 const RecoverOptions& options, const TargetSinks& tell,
                 const ProgressSink& progress) {
    check_options(options);
    StageTimer timer;
    timer.start("reading");
    std::optional<SavedReference> saved = read_saved(options, progress);
    report_progress(progress, "reading", 0, "smoothing the segmentations");
    auto reading = std::async(std::launch::async,
                              [&] { return make_states(targets, options.settings, tell); });
    LabelledState reference_state = make_state(reference, options.settings);
    ReadyLabels states = reading.get();
    const auto align = [&](const ReferenceState& state) {
        ReadyTargets aligned;
        for (auto& target : states) {
            if (target.error)
                aligned.push_back({target.number, std::nullopt, target.error});
            else
                aligned.push_back(made_ready(target.number, tell, [&] {
                    return align_target(std::move(*target.state), state, options, progress);
                }));
        }
        return aligned;
    };
    recover_aligned(std::move(reference_state), std::move(saved), all_at_once(align),
                    repetitions(reference, targets), options, timer, tell, progress);
}

void recover_each(const Segmentation& reference, std::size_t num_targets, const ReadTarget& read,
                  const RecoverOptions& options, const TargetSinks& tell,
                  const ProgressSink& progress) {
    check_options(options);
    StageTimer timer;
    timer.start("reading");
    std::optional<SavedReference> saved = read_saved(options, progress);
    report_progress(progress, "reading", 0, "smoothing the segmentation");
    std::size_t at = 0;
    const TargetStream one_by_one = [&](const ReferenceState& state) {
        if (at == num_targets) return NextTarget();
        const std::size_t k = at++;
        return std::make_unique<Ready<TargetState>>(made_ready(k, tell, [&] {
            return align_target(make_state(read(k), options.settings), state, options, progress);
        }));
    };
    TargetSinks alone = tell;
    alone.joint = nullptr;  // which must know all volumes
    recover_aligned(make_state(reference, options.settings), std::move(saved), one_by_one,
                    std::vector<std::string>(num_targets), options, timer, alone, progress);
}

RecoveryResult recover(const Segmentation& reference, const PartialTarget& target,
                       const RecoverOptions& options, const ProgressSink& progress) {
    check_options(options);
    check_partial_target(target, options);
    StageTimer timer;
    timer.start("reading");
    std::optional<SavedReference> saved = read_saved(options, progress);
    report_progress(progress, "reading", 0, "smoothing the segmentation");
    const auto place = [&](const ReferenceState& state) {
        ReadyTargets placed;
        placed.push_back({0, place_target(target, state, options)});
        return placed;
    };
    RecoveryResult only;
    const auto keep = [&](std::size_t, RecoveryResult result, double) { only = std::move(result); };
    recover_aligned(make_state(reference, options.settings), std::move(saved), all_at_once(place),
                    {""}, options, timer, {keep}, progress);
    return only;
}

RecoveryResult recover(const Segmentation& reference, const Segmentation& target,
                       const RecoverOptions& options, const ProgressSink& progress) {
    RecoveryResult only;
    recover_all(reference, {target}, options,
                {[&](std::size_t, RecoveryResult result, double) { only = std::move(result); }},
                progress);
    return only;
}

}  // namespace palpate
