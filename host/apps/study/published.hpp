// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// A stiffness that somebody recovered and published, beside the one that was expected, kPa.
struct PublishedStiffness {
    double expected_kpa = 0, found_kpa = 0;
    std::string scene;
};

/// All of Lee, Foskey, Niethammer, Krajcevski and Lin: joint recovery of elasticity and forces, CT
/// of the male pelvis, mesh of 6,119 nodes, voxels of 1 x 1 x 3 mm, surrounding tissue of 10 kPa.
std::string published_source();

/// Linear elements, two synthetic scenes, 50 to 350 kPa.
std::vector<PublishedStiffness> published_recovery();
/// Neo-Hookean elements, two synthetic scenes, 50 to 200 kPa.
std::vector<PublishedStiffness> published_neo_hookean();
/// Scene 2, tissue of 20 kPa taken for 10 kPa: half of the true value is expected.
std::vector<PublishedStiffness> published_surroundings();

/// A tumour of 100 kPa that fills part of a prostate of 50 kPa, recovered as one.
struct PublishedTumour {
    double fraction = 0;
    double scene_1_kpa = 0, scene_2_kpa = 0;
};
std::vector<PublishedTumour> published_tumour();

/// What a wrong Poisson's ratio did, in words, by true ratio (0.40 was assumed).
struct PublishedPoisson {
    double poisson_ratio = 0;
    std::string error;
};
std::vector<PublishedPoisson> published_poisson();

/// Mean landmark error of five patients, mm.
struct PublishedLandmarks {
    double joint_mm = 0, demons_mm = 0;
};
std::vector<PublishedLandmarks> published_landmarks();

/// One law of sucked tissue, fitted to one measurement with a bulk modulus that was assumed.
struct PublishedSuckedTissue {
    double kappa_kpa = 0, mu_kpa = 0, gamma = 0, amplitude = 0, time_s = 0;
};
std::vector<PublishedSuckedTissue> published_sucked_tissue();
std::string published_sucked_tissue_source();

}  // namespace palpate
