// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/phantom/pelvis.hpp"
#include "host/apps/recover/result/recovery_result.hpp"
#include "host/apps/study/studies.hpp"

namespace palpate {

/// A pelvis phantom and what its recovery is told of it.
struct PelvisCase {
    PelvisOptions truth;
    double expected_kpa = 0;                ///< 0: the true stiffness
    std::function<void(Settings&)> assume;  ///< changes the phantom's settings; may be empty
    std::vector<std::pair<std::string, std::string>> labels;  ///< further values of its row, first
};

/// "seed-3-e50-tumour_fraction-0.25": seed, stiffness and labels.
std::string id_of(const PelvisCase& work);
/// The same for people.
std::string title_of(const PelvisCase& work);
/// Makes, recovers and describes it with `pelvis_row`.
StudyCase study_case(const PelvisCase& work, const StudyOptions& options);

struct PelvisOutcome {
    PelvisPhantom phantom;
    RecoveryResult result;
    const RegionResult& prostate() const;
};

/// The phantom's options that do not vary inside a study.
PelvisOptions pelvis_options(const StudyOptions& options, unsigned seed, double stiffness_kpa);
/// Seed and stiffness as log-uniform from 40 to 350 kPa: the same for the same seed.
double drawn_stiffness_kpa(unsigned seed);

/// Makes the phantom in memory and recovers it.
PelvisOutcome run_pelvis_case(const PelvisCase& work, const StudyOptions& options,
                              const ProgressSink& progress);

/// Names of the values that `pelvis_row` gives.
std::vector<std::string> pelvis_columns();
Row pelvis_row(const PelvisCase& work, const PelvisOutcome& outcome);

/// For truths on the elements that they are recovered with.
StudyOptions with_linear_truths(StudyOptions options);

/// Distances (mm) between the field and the true displacement at the phantom's landmarks; the field
/// is linear between voxel centres.
std::vector<double> landmark_errors_mm(const PelvisPhantom& phantom, const Image<Vec3>& field);

/// What the rows of a study of pelvis phantoms depend on.
std::vector<std::pair<std::string, std::string>> pelvis_settings(const StudyOptions& options);

}  // namespace palpate
