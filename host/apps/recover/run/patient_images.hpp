// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/apps/recover/pipeline/recover.hpp"
#include "host/apps/recover/report/grey_picture.hpp"
#include "host/io/option_values.hpp"

namespace palpate {

/// Paths of the images for the report.
struct ImagePaths {
    std::optional<std::string> reference;
    std::vector<std::string> targets;
};

/// Of values with the options "reference_image" and "target_image". Throws Error(invalid_argument)
/// unless there is an image for every target that is a label volume, or for none;
/// Error(input_unreadable) for an empty name.
ImagePaths image_paths(const OptionValues& values, std::size_t num_label_volumes);

struct PatientImage {
    Image<float> image;
    std::vector<std::string> warnings;  ///< sentences for the result
};

/// What one result shows.
struct PatientImages {
    std::optional<PatientImage> reference, target;

    GreyImages shown() const;
    void add_warnings(RecoveryResult& result) const;
};

/// Nothing if no image was given. Throws what `read_scalar_image` throws, and
/// Error(input_unusable) for an image that shows no voxel of the organs in its segmentation.
std::optional<PatientImage> read_reference_image(const ImagePaths& paths, const Settings& settings,
                                                 const Segmentation& reference,
                                                 const ProgressSink& progress);
/// The same for target `k`.
std::optional<PatientImage> read_target_image(const ImagePaths& paths, std::size_t k,
                                              const Settings& settings, const Segmentation& target,
                                              const ProgressSink& progress);

}  // namespace palpate
