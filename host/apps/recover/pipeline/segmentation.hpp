// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/io/label_image.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// A label volume and what messages and reports call it.
struct Segmentation {
    LabelImage labels;
    std::string name;
    std::vector<std::string> warnings = {};  ///< sentences about what is odd in its file
};

Segmentation read_segmentation(const std::filesystem::path& path,
                               const ProgressSink& progress = {});

/// Whether both have the same labels at the same places.
bool is_same(const Segmentation& a, const Segmentation& b);

}  // namespace palpate
