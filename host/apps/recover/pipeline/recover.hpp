// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/apps/recover/pipeline/partial_target.hpp"
#include "host/apps/recover/pipeline/recover_options.hpp"
#include "host/apps/recover/pipeline/segmentation.hpp"
#include "host/apps/recover/result/joint_result.hpp"
#include "host/apps/recover/result/recovery_result.hpp"
#include "solver/base/error.hpp"

namespace palpate {

/// Receives the result of each target, in order, and the seconds that it took beyond what is done
/// once for all targets.
using ResultSink =
    std::function<void(std::size_t target, RecoveryResult result, double own_seconds)>;

/// Receives the error that ended the work on one target.
using FailureSink = std::function<void(std::size_t target, const Error& error)>;

using JointSink = std::function<void(JointResult result)>;

/// Who is told what of several targets.
struct TargetSinks {
    ResultSink result;
    FailureSink failed = {};  ///< empty: errors of one target go to the caller
    JointSink joint = {};     ///< empty: no joint estimate
    /// Called when the reference is meshed and condensed, before anything is searched.
    std::function<void(const BodyMesh& body)> prepared = {};
    /// Called before target k is searched.
    std::function<void(std::size_t k)> started = {};
    /// A target that cannot be made ready or aligned goes to `failed`, too; else to the caller,
    /// before anything is computed.
    bool goes_on_without = false;
};

/// The main job: two segmentations in, moduli, forces, field and error bars out. Throws
/// Error with the codes of each station, Error(invalid_argument) for options that do not go
/// together; not converging is reported in the result.
RecoveryResult recover(const Segmentation& reference, const Segmentation& target,
                       const RecoverOptions& options, const ProgressSink& progress = {});

/// The same for a target made of surfaces and points. It is in the reference's frame unless
/// `options.initial_transform` says otherwise. Dice and labels on a target grid do not exist then.
/// Throws Error(invalid_argument) for organs that are unknown, fixed or given twice and for options
/// that need a label volume, Error(input_unusable) for a shape of another size or place than its
/// organ.
RecoveryResult recover(const Segmentation& reference, const PartialTarget& target,
                       const RecoverOptions& options, const ProgressSink& progress = {});

/// The same for several targets of one reference, which is meshed and condensed once. All targets
/// are read and aligned before that, so that a wrong one is told early. An Error while one target
/// is searched or its sink runs goes to `failed`, and the next target follows. Where two targets or
/// more were searched by `map`, with the linear law and given ratios, a joint estimate follows of
/// those that converged and whose labels are neither the reference's nor an earlier target's.
void recover_all(const Segmentation& reference, const std::vector<Segmentation>& targets,
                 const RecoverOptions& options, const TargetSinks& tell,
                 const ProgressSink& progress = {});

/// The same without a joint estimate, for as many targets as there are: each is read by `read` when
/// the one before is searched, so that two are in memory at a time. What is wrong with one is told
/// then.
using ReadTarget = std::function<Segmentation(std::size_t target)>;
void recover_each(const Segmentation& reference, std::size_t num_targets, const ReadTarget& read,
                  const RecoverOptions& options, const TargetSinks& tell,
                  const ProgressSink& progress = {});

}  // namespace palpate
