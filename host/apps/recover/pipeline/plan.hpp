// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "host/apps/recover/pipeline/recover_options.hpp"
#include "host/apps/recover/pipeline/segmentation.hpp"
#include "host/apps/recover/report/plan_report.hpp"

namespace palpate {

/// The motion and the contours that a plan supposes.
struct PlanOptions {
    double motion_mm = 3;  ///< of driven walls along their normals
    /// Standard deviation of the contours' error in each image; empty: what the settings give, or
    /// `usual_contour_mm`.
    std::optional<double> contour_mm;
};

constexpr double usual_contour_mm = 0.5;

/// The contours' error that a plan supposes.
double planned_contour_mm(const PlanOptions& plan, const Settings& settings);

/// What intervals to expect, from the reference alone: walls move by `motion_mm` along their
/// normals, organs are as stiff as their prior's median, a third and three times of it, and the
/// surfaces show that with the noise of voxels and contours. Curvature of F (JointProblem) there.
/// The target is aligned as `options` say. A target that would leave a modulus not identifiable is
/// told as such. Throws Error(input_unusable) if no modulus or a Poisson's ratio is unknown or no
/// wall is driven.
std::vector<PlanRow> plan_recovery(const Segmentation& reference, const RecoverOptions& options,
                                   const PlanOptions& plan, const ProgressSink& progress = {});

}  // namespace palpate
