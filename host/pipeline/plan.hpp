// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/pipeline/recover.hpp"
#include "host/report/plan_report.hpp"

namespace palpate {

/// The motion and the contours that a plan supposes.
struct PlanOptions {
    double motion_mm = 3;     ///< of driven walls along their normals
    double contour_mm = 0.5;  ///< standard deviation of the contours' error in each image
};

/// What intervals to expect, from the reference alone: walls move by `motion_mm` along their
/// normals, organs are as stiff as their prior's median, a third and three times of it, and the
/// surfaces show that with the noise of voxels and contours. Curvature of F (JointProblem) there.
/// Throws Error(input_unusable) if no modulus is unknown or no wall is driven.
std::vector<PlanRow> plan_recovery(const Segmentation& reference, const RecoverOptions& options,
                                   const PlanOptions& plan, const ProgressSink& progress = {});

}  // namespace palpate
