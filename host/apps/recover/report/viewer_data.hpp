// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/report/shown_picture.hpp"
#include "host/page/surface_view.hpp"

namespace palpate {

/// The organs' surfaces in the reference's frame with what is known at their vertices.
SurfaceView recovery_view(const RecoveryResult& result);

/// What the slices of the report are cut from beside `recovery_view`, as JSON that may stand inside
/// a <script> element: cropped label volumes (base64 run lengths) with their place in the
/// reference's frame, and pictures (base64 PNG) that fill the same box.
std::string viewer_data(const RecoveryResult& result, const LabelVolumes& volumes,
                        const ShownPictures& pictures = {});

}  // namespace palpate
