// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/phantom/contour_error.hpp"
#include "host/apps/phantom/wall_motion.hpp"
#include "host/apps/study/study.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// What a user can choose of a study.
struct StudyOptions {
    unsigned first_seed = 1;
    int phantoms = 0;             ///< anatomies; 0: as many as the study was made for
    Index phantom_nodes = 30000;  ///< of the meshes that truths are solved on
    ElementType phantom_element = ElementType::tet10;  ///< of those meshes
    Vec3 spacing{1, 1, 1};                             ///< mm, of the label volumes
    ContourErrorOptions contours;                      ///< how both label volumes are drawn
    LoadFamily load = LoadFamily::mixed;
    AnatomyFamily anatomy = AnatomyFamily::usual;
    double tangential = 1;  ///< factor on the walls' motion along themselves
    MesherOptions mesher;   ///< of the recovery; `num_nodes` is its mesh size
    LinearSolverOptions solver;
};

struct StudyEntry {
    std::string name;
    std::string about;  ///< one line for --help
    int phantoms = 1;   ///< default of `StudyOptions::phantoms`; 0: it makes no pelvis phantoms
    Study (*make)(const StudyOptions& options);
    bool has_images = true;  ///< it recovers from label volumes, which can be drawn badly
    /// Of the options of phantoms and meshes it uses how many, and the first seed.
    bool counts_cases = false;
};

/// All studies; `make` gets options with a number of phantoms.
const std::vector<StudyEntry>& study_registry();

Study make_coverage_study(const StudyOptions& options);
Study make_recovery_study(const StudyOptions& options);
Study make_exact_surfaces_study(const StudyOptions& options);
Study make_neo_hookean_study(const StudyOptions& options);
Study make_surroundings_study(const StudyOptions& options);
Study make_poisson_study(const StudyOptions& options);
Study make_tumour_study(const StudyOptions& options);
Study make_parameter_scan(const StudyOptions& options);
Study make_sensitivity_study(const StudyOptions& options);
Study make_registration_study(const StudyOptions& options);
Study make_zones_study(const StudyOptions& options);
Study make_aspiration_contours_study(const StudyOptions& options);
Study make_aspiration_kappa_study(const StudyOptions& options);
Study make_aspiration_friction_study(const StudyOptions& options);
Study make_aspiration_laws_study(const StudyOptions& options);

}  // namespace palpate
