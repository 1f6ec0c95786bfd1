// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/report/label_volumes.hpp"

namespace palpate {

/// What the scripts of the report draw, as JSON that may stand inside a <script> element:
/// surfaces (base64 fp32 and uint32 arrays) and cropped label volumes (base64 run lengths).
std::string viewer_data(const RecoveryResult& result, const LabelVolumes& volumes);

}  // namespace palpate
