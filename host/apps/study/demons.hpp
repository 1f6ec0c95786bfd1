// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/io/label_image.hpp"

namespace palpate {

struct DemonsOptions {
    int levels = 3;                       ///< each half as fine as the next
    int iterations = 100;                 ///< on each level
    double field_smoothing_voxels = 1.5;  ///< sd of the Gaussian on the field after each step
    double label_smoothing_mm = 1.0;      ///< sd of the Gaussian on the intensities of the labels
};

/// Displacement (mm, LPS) on the grid of `reference` that takes it to `target`, from intensities
/// alone: ITK's diffeomorphic demons (Vercauteren, Pennec, Perchant, Ayache 2009) on label volumes
/// whose labels have been given grey values as in a CT and were smoothed. It knows no mechanics:
/// what a registration finds without them.
/// Throws Error(internal) with ITK's words if ITK fails.
Image<Vec3> demons_displacement(const LabelImage& reference, const LabelImage& target,
                                const DemonsOptions& options = {});

}  // namespace palpate
