// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/studies.hpp"

namespace palpate {

const std::vector<StudyEntry>& study_registry() {
    static const std::vector<StudyEntry> entries{
        {"coverage", "Do the 95 % intervals hold the truth? Many phantoms, 40 to 350 kPa", 60,
         make_coverage_study},
        {"recovery", "Two scenes of 50 to 350 kPa beside published values", 2, make_recovery_study},
        {"exact-surfaces", "Two scenes without voxels: truth on the same mesh, and on a finer one",
         2, make_exact_surfaces_study, false},
        {"neo-hookean", "Large deformation, truth on the same mesh, beside published values", 2,
         make_neo_hookean_study, false},
        {"surroundings", "Surrounding tissue that is twice as stiff as assumed", 2,
         make_surroundings_study},
        {"poisson", "A Poisson's ratio of the prostate that is not the assumed one", 2,
         make_poisson_study},
        {"tumour", "A tumour without label in a part of the prostate", 2, make_tumour_study},
        {"zones", "Two zones of unknown stiffness, and phantoms built to be unidentifiable", 20,
         make_zones_study},
        {"parameter-scan", "The objective over the stiffness, and the influence of the prior", 1,
         make_parameter_scan},
        {"sensitivity", "Two spheres in closed form: what their surface shows of a stiffness", 0,
         make_sensitivity_study},
        {"registration", "Landmarks inside the prostate against ITK's demons", 10,
         make_registration_study},
        {"aspiration-contours",
         "Outlines of sucked tissue from frames with a known outline, beside the published method",
         12, make_aspiration_contours_study, false, true},
        {"aspiration-kappa", "Sucked tissue whose bulk modulus is assumed too small", 0,
         make_aspiration_kappa_study, false},
        {"aspiration-friction", "Sucked tissue that sticks to the tube and is taken to slide", 0,
         make_aspiration_friction_study, false},
        {"aspiration-laws", "Which law and how many relaxation terms sucked tissue has", 20,
         make_aspiration_laws_study, false, true},
    };
    return entries;
}

}  // namespace palpate
