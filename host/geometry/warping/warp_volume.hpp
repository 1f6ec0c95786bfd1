// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/geometry/warping/displacement_field.hpp"
#include "host/io/label_image.hpp"

namespace palpate {

enum class Interpolation {
    nearest,
    linear,
    cubic,   ///< B-spline through the voxels; may over- and undershoot by some percent
    smooth,  ///< labels only: nearest smoothed surface, as `LabelField` describes it
};

/// Voxels of an output that something had to be assumed for.
struct OutsideCounts {
    std::size_t field = 0;   ///< beyond the displacement field, which was continued from its border
    std::size_t folded = 0;  ///< where the field could not be inverted
    std::size_t image = 0;   ///< their content lies beyond the input: they got the fill value
};

template <typename T>
struct Warped {
    Image<T> image;
    OutsideCounts outside;
};

/// Carries a volume to `grid`: out(y) = image(x) where `back` takes y to x. Up to half a voxel
/// beyond its outermost centres the image holds their values; further out lies `fill`.
/// Throws Error(invalid_argument) for Interpolation::smooth.
Warped<float> warp_image(const Image<float>& image, const PointMap& back, const ImageGrid& grid,
                         Interpolation interpolation, float fill = 0);

/// The same for labels; outside lies label 0. Throws Error(invalid_argument) for linear and cubic,
/// Error(unsupported) for `smooth` with more than 255 labels.
Warped<std::uint16_t> warp_labels(const LabelImage& labels, const PointMap& back,
                                  const ImageGrid& grid, Interpolation interpolation);

}  // namespace palpate
