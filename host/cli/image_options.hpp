// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/pipeline/recover.hpp"
#include "host/report/grey_picture.hpp"

namespace palpate {

/// Images for the report, as the user named them.
struct ImageArguments {
    std::string reference;
    std::vector<std::string> targets;
};

void add_image_options(CLI::App& command, ImageArguments& arguments);

/// Throws Error(invalid_argument) unless there is an image for every target that is a label volume,
/// or for none.
void check_number_of_images(const ImageArguments& arguments, std::size_t num_label_volumes);

/// The images that were given, read.
struct PatientImages {
    std::optional<Image<float>> reference;
    std::vector<Image<float>> targets;               ///< one for each target, or none
    std::vector<std::string> reference_warnings;     ///< sentences for every result
    std::vector<std::vector<std::string>> warnings;  ///< for the result of one target

    GreyImages of_target(std::size_t target) const;
    void add_warnings(std::size_t target, RecoveryResult& result) const;
};

/// Throws what `read_scalar_image` throws, and Error(input_unusable) for an image that shows no
/// voxel of the organs in its segmentation.
PatientImages read_images(const ImageArguments& arguments, const Settings& settings,
                          const Segmentation& reference, const std::vector<Segmentation>& targets,
                          const ProgressSink& progress);

}  // namespace palpate
