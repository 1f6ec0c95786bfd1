// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace palpate {

/// No contours of two images that are further off together (mm) are looked for.
constexpr double most_contour_mm = 1.5;

/// How walls may move before anything is known of them. Closest points hold a wall along itself
/// where it came to lie, so that of several valleys the one is found that this leads to.
enum class FirstWalls {
    bodies,   ///< as bodies that hardly change their shape, then as expected
    sliding,  ///< along themselves three times as far as expected, with half the range
    broad,    ///< along themselves a third as far, with twice the range
};

/// Where another search of the same target has ended.
struct KnownEnd {
    Eigen::VectorXd driven, theta, sd_ln;
};

struct MapOptions {
    int max_iterations = 40;
    // Converged: three steps in a row of which none would change ln E by more than the first times
    // its posterior standard deviation, or the objective (a log posterior) by more than the second
    // times the number of surface points.
    double modulus_tolerance_sd = 0.02;
    double objective_tolerance_per_row = 2e-4;
    double smallest_kpa = 0.1, largest_kpa = 1e5;  ///< the search stays between these
    /// If above 1: every modulus stays within this factor of where the search starts.
    double reach = 0;
    double start_kpa = 0;        ///< of all unknown moduli; 0: the prior's median
    bool estimate_noise = true;  ///< find what is not given of the noise from the observed surface
    /// Standard deviation (mm) of the error of both images' contours together, which neighbouring
    /// points share. Empty: found. Given, the scale of sigma_n is found instead.
    std::optional<double> contour_mm;
    /// The share of that error's variance that belongs to single slices. Empty: found.
    std::optional<double> slice_share;
    /// What is expected of the walls' motion is fitted to their own distances (fit_walls).
    bool fit_walls = true;
    double smallest_noise_scale = 1;  ///< lower for surfaces without voxels
    FirstWalls first_walls = FirstWalls::bodies;
    /// A search that comes there ends, without intervals.
    std::optional<KnownEnd> known_end;
    /// The size of the noise and the terraces are held from here on, so that the steps can settle.
    int noise_iterations = 6;
};

}  // namespace palpate
