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

/// What a model says at the same values on two sizes of cells, or of time steps: the usual ones and
/// those of half the size.
struct HalvedModel {
    std::shared_ptr<const Prediction> usual, halved;
};

/// The same by two pairs at the values of `found` or near them: one for cells, with time steps of
/// twice the size in both, and one for time steps, with such cells.
void check_mesh(const std::vector<HalvedModel>& pairs, IdentifiedExperiment& found,
                const Eigen::VectorXd& model_sd = {});

}  // namespace palpate
