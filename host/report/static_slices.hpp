// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/report/label_volumes.hpp"

namespace palpate {

/// The three views of the report. Axial: left of the picture is the patient's right, top is
/// anterior; coronal the same with the head on top; sagittal: left is anterior, top the head.
enum class SliceView { axial, coronal, sagittal };

/// One slice as SVG in true proportions (mm): reference areas, target and warped outlines. Shown
/// where scripts do not run; the slice viewer draws the same with a slider.
std::string static_slice_svg(const RecoveryResult& result, const LabelVolumes& volumes,
                             SliceView view);

}  // namespace palpate
