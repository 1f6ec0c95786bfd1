// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/segmentation.hpp"

#include "host/io/volume_files.hpp"

namespace palpate {

Segmentation read_segmentation(const std::filesystem::path& path, const ProgressSink& progress) {
    Segmentation segmentation;
    segmentation.labels = read_label_image(path, progress, &segmentation.warnings);
    segmentation.name = path.filename().string();
    return segmentation;
}

bool is_same(const Segmentation& a, const Segmentation& b) {
    return a.labels.grid.is_like(b.labels.grid) && a.labels.voxels == b.labels.voxels;
}

}  // namespace palpate
