// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/report/grey_picture.hpp"
#include "host/apps/recover/result/recovery_result.hpp"
#include "host/geometry/warping/field_files.hpp"

namespace palpate {

/// report.html: one file that needs nothing else and fetches nothing. Findings in words, tables,
/// 3D surfaces that can be turned, slices with contours, convergence and profile plots. Without
/// scripts or WebGL the tables, plots and a few fixed slices remain.
/// Every text from outside is escaped. `images` lie under the outlines of the slices; `fields` are
/// the displacement fields that lie beside the page.
std::string html_report(const RecoveryResult& result, bool include_file_names = false,
                        const GreyImages& images = {}, FieldChoice fields = FieldChoice::one);

}  // namespace palpate
