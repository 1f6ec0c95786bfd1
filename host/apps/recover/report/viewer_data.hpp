// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/report/shown_picture.hpp"

namespace palpate {

/// What the scripts of the report draw, as JSON that may stand inside a <script> element:
/// surfaces (base64 fp32 and uint32 arrays) in the reference's frame, cropped label volumes (base64
/// run lengths) with their place in that frame, and pictures (base64 PNG) that fill the same box.
std::string viewer_data(const RecoveryResult& result, const LabelVolumes& volumes,
                        const ShownPictures& pictures = {});

}  // namespace palpate
