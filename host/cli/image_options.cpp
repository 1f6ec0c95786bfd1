// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cli/image_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/imaging/io.hpp"
#include "host/warping/displacement_field.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Part of the organs' voxels that lie in an image.
double share_shown(const LabelImage& labels, const Settings& settings, const ImageGrid& image) {
    std::vector<bool> is_organ(65536, false);
    for (const auto& organ : settings.organs)
        if (organ.label > 0 && organ.label < 65536) is_organ[std::size_t(organ.label)] = true;
    std::size_t shown = 0, all = 0;
    const auto& size = labels.grid.size;
    for (Index k = 0; k < size[2]; ++k)
        for (Index j = 0; j < size[1]; ++j)
            for (Index i = 0; i < size[0]; ++i) {
                if (!is_organ[labels.at(i, j, k)]) continue;
                ++all;
                shown += is_inside(image, labels.grid.to_point(Vec3(i, j, k)));
            }
    return all ? double(shown) / double(all) : 1.0;  // labels without organs are refused elsewhere
}

Image<float> read_image_of(const Segmentation& segmentation, const std::string& path,
                           const char* which, const Settings& settings,
                           std::vector<std::string>& warnings, const ProgressSink& progress) {
    constexpr double nearly_all = 0.95;
    std::vector<std::string> oddities;
    Image<float> image = read_scalar_image(path, &oddities, progress);
    const double share = share_shown(segmentation.labels, settings, image.grid);
    if (share == 0)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("cannot use '{}': it shows no voxel of the organs in the {}'s "
                                "labels; give the image that they were drawn on",
                                path, which));
    if (share < nearly_all)
        oddities.push_back(
            fmt::format("It shows only {:.0f} % of the organs' voxels.", 100 * share));
    const auto& told = segmentation.warnings;  // labels and image often have one odd header
    for (const std::string& oddity : oddities)
        if (std::find(told.begin(), told.end(), oddity) == told.end())
            warnings.push_back(fmt::format("Image of the {}: {}", which, oddity));
    return image;
}

}  // namespace

void add_image_options(CLI::App& command, ImageArguments& arguments) {
    command.add_option(
        "--reference-image", arguments.reference,
        "Grey volume that the reference's labels were drawn on, shown under the "
        "outlines in report.html, which then holds the patient's anatomy (faces, and "
        "names burnt in)");
    command.add_option("--target-image", arguments.targets,
                       "The same for the target; as many files as targets, in their order");
}

void check_number_of_images(const ImageArguments& arguments, std::size_t num_label_volumes) {
    const std::size_t given = arguments.targets.size();
    if (given == 0 || given == num_label_volumes) return;
    throw Error(ErrorCode::invalid_argument,
                num_label_volumes == 0
                    ? "--target-image belongs to a label volume of the target; beside "
                      "--target-surface and --target-points only --reference-image can be shown"
                    : fmt::format("--target-image names {} file{} for {} target{}; give one image "
                                  "for each target, in the same order",
                                  given, given == 1 ? "" : "s", num_label_volumes,
                                  num_label_volumes == 1 ? "" : "s"));
}

GreyImages PatientImages::of_target(std::size_t target) const {
    GreyImages images;
    if (reference) images.reference = &*reference;
    if (target < targets.size()) images.target = &targets[target];
    return images;
}

void PatientImages::add_warnings(std::size_t target, RecoveryResult& result) const {
    const auto append = [&](const std::vector<std::string>& sentences) {
        result.warnings.insert(result.warnings.end(), sentences.begin(), sentences.end());
    };
    append(reference_warnings);
    if (target < warnings.size()) append(warnings[target]);
}

PatientImages read_images(const ImageArguments& arguments, const Settings& settings,
                          const Segmentation& reference, const std::vector<Segmentation>& targets,
                          const ProgressSink& progress) {
    PatientImages images;
    if (!arguments.reference.empty())
        images.reference = read_image_of(reference, arguments.reference, "reference", settings,
                                         images.reference_warnings, progress);
    images.warnings.resize(arguments.targets.size());
    for (std::size_t k = 0; k < arguments.targets.size(); ++k)
        images.targets.push_back(read_image_of(targets.at(k), arguments.targets[k], "target",
                                               settings, images.warnings[k], progress));
    return images;
}

}  // namespace palpate
