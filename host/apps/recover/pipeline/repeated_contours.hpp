// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/pipeline/segmentation.hpp"

namespace palpate {

/// How far the contours of one image are off (standard deviation, mm), from two segmentations of
/// it that were drawn independently: of the distances d of the first's surfaces to the second's, of
/// all organs but the fixed ones,
///   s^2 = (mean d^2) / 2 - sigma_n^2,
/// sigma_n what voxels alone leave (`noise_voxels`), 0 where that is more. Throws
/// Error(input_unusable) if the two are not of one image: another grid, or an organ is in one only.
double contour_sd_of(const Segmentation& first, const Segmentation& second,
                     const Settings& settings);

}  // namespace palpate
