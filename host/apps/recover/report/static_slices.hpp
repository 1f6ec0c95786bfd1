// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/report/shown_picture.hpp"

namespace palpate {

/// The three views of the report. Axial: left of the picture is the patient's right, top is
/// anterior; coronal the same with the head on top; sagittal: left is anterior, top the head.
enum class SliceView { axial, coronal, sagittal };

/// What lies under the outlines.
enum class SliceGround { plain, reference, target };

/// One slice as SVG in true proportions (mm): on plain ground reference areas, target and warped
/// outlines; on the picture of the target the two outlines, on that of the reference its own. Shown
/// where scripts do not run; the slice viewer draws the same with a slider.
std::string static_slice_svg(const RecoveryResult& result, const LabelVolumes& volumes,
                             SliceView view, const ShownPictures& pictures = {},
                             SliceGround ground = SliceGround::plain);

/// The three views as figures of one scale, which the slice viewer takes over: in a row, or, on
/// pictures of flat volumes, coronal and sagittal views one below the other beside a larger axial
/// one.
///   kind  class of the row, besides "slices"
std::string slice_figures(const RecoveryResult& result, const LabelVolumes& volumes,
                          const ShownPictures& pictures, SliceGround ground,
                          const std::string& kind = "");

/// What the slices can lie on, in the order of the viewer: the first at once, the second on paper,
/// too.
std::vector<SliceGround> slice_grounds(const ShownPictures& pictures);

}  // namespace palpate
