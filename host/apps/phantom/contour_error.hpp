// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/geometry/fields/label_field.hpp"
#include "host/io/label_image.hpp"

namespace palpate {

/// How somebody's contours differ from the true surface.
enum class ContourStyle {
    exact,
    exponential,  ///< exp(-d / l): rough
    matern32,     ///< (1 + q) exp(-q), q = sqrt(3) d / l
    squared,      ///< exp(-(d / l)^2 / 2): smooth
    slices,       ///< each slice shifted and waved in its plane by itself
    drawn,        ///< one of these at random, as is the length
};

struct ContourErrorOptions {
    ContourStyle style = ContourStyle::exact;
    double sd_mm = 0;      ///< along the normal, 0..2; of `slices` along one in the slice's plane
    double length_mm = 7;  ///< l, 1..50
};

/// "exact", or STYLE:SD:LENGTH such as "matern32:0.5:7", or "drawn:SD". Throws
/// Error(invalid_argument).
ContourErrorOptions contour_error_of(const std::string& text);
/// Style and length (4 to 12 mm) drawn for a seed, if that is what `options` say.
ContourErrorOptions drawn_for(ContourErrorOptions options, unsigned seed);
std::string to_text(const ContourErrorOptions& options);

/// A random field on space of standard deviation 1: cosine waves whose wave vectors are drawn from
/// the kernel's spectral density (random Fourier features; Rahimi and Recht 2007). The field of
/// `slices` is that of one slice.
class RandomField {
public:
    RandomField(ContourStyle style, double length_mm, std::uint64_t seed);
    double value(const Vec3& point) const;

private:
    std::vector<Vec3> waves_;  ///< per mm
    std::vector<double> phases_;
};

/// What is drawn of the organs whose true surfaces are the zero levels of `truth`, on `grid`: each
/// contour is off along its normal by a field of its own. A voxel claimed by several organs is that
/// of the one in which it lies deepest. The same for the same seed.
RegionImage drawn_regions(const LabelField& truth, const ImageGrid& grid,
                          const ContourErrorOptions& options, std::uint64_t seed);

/// Gives the voxels of region `whole` of `drawn` that lie in region `part` of `truth` its number;
/// the border between the two is off like an outline.
void draw_border(const LabelField& truth, Index whole, Index part,
                 const ContourErrorOptions& options, std::uint64_t seed, RegionImage& drawn);

}  // namespace palpate
