// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "host/apps/identify/identified_tree.hpp"

namespace palpate {

/// The errors of mesh and time steps out of the values of `found` and into its intervals, by one
/// simulation each on cells and steps of half the size; `found.mesh_check_sentence` tells what
/// became of it.
///   configure   sets how equations are solved
///   model_sd    as `correct_for_discretisation` has it
void check_mesh(const std::function<void(SimulationSettings&)>& configure,
                IdentifiedExperiment& found, const ProgressSink& progress,
                const Eigen::VectorXd& model_sd = {});

/// The same by what the model says at the values of `found` with cells of twice the size, and with
/// time steps of twice the size.
void check_mesh(const std::vector<std::shared_ptr<const Prediction>>& coarser,
                IdentifiedExperiment& found, const Eigen::VectorXd& model_sd = {});

}  // namespace palpate
