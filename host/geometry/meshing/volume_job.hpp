// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/meshing/exchange.hpp"

namespace palpate {

/// The frame of the volume mesher: axes of the image, origin at the low corner of the image box,
/// mm.
struct BoxFrame {
    Mat3 axes = Mat3::Identity();  ///< columns: image axes in LPS
    Vec3 corner = Vec3::Zero();    ///< LPS
    Vec3 size = Vec3::Zero();      ///< of the box

    explicit BoxFrame(const ImageGrid& grid);
    Vec3 to_lps(const Vec3& local) const { return corner + axes * local; }
    Vec3 to_local(const Vec3& lps) const { return axes.transpose() * (lps - corner); }
    bool is_left_handed() const { return axes.determinant() < 0; }
};

/// Samples the field of every region over the image box, three samples per edge length or more, for
/// the volume mesher. A constant is added to the field of each organ so that, on the samples, it
/// fills the volume of its voxels (smoothing shrinks small organs).
void add_sampled_field(const RegionImage& image, const LabelField& field, double edge_length_mm,
                       Exchange& job);

}  // namespace palpate
