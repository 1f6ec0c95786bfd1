// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/apps/recover/inverse/map_estimate.hpp"
#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/result/recovery_result.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// What the search of one target leaves for a joint estimate.
struct JointTarget {
    std::shared_ptr<const LinearisedProblem> problem;
    // What it refers to, if its walls were fitted; else what it was searched with must live on.
    std::shared_ptr<const WallPrior> walls;
    std::shared_ptr<const ResponseModel> response;
    NoiseLevel noise;
    Eigen::VectorXd mesh_change_ln;  ///< as in MapEstimate
    std::string told_alone;          ///< why it cannot be put together with others; empty if it can
};

/// Empty `problem` where the search has none: another method than `map`.
JointTarget joint_target(const MapEstimate& estimate, const Settings& settings);

/// The moduli of one reference from several of its targets together (JointProblem): the regions of
/// an unknown modulus that is observed, with interval and verdict. None without unknown moduli.
std::vector<RegionResult> joint_estimate(const std::vector<JointTarget>& targets,
                                         const Settings& settings, const MapOptions& options,
                                         const ProgressSink& progress);

}  // namespace palpate
