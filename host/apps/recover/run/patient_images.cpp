// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/run/patient_images.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/geometry/warping/displacement_field.hpp"
#include "host/io/volume_files.hpp"
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

std::string told_share(double share) {
    if (share < 0.01) return "It shows less than 1 % of the organs' voxels.";
    return fmt::format("It shows only {:.0f} % of the organs' voxels.", 100 * share);
}

bool is_one_number(const std::vector<float>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(),
                       [&](float number) { return number == numbers.front(); });
}

/// An image that shows no organ is refused.
std::vector<std::string> oddities_of(const Image<float>& image, double share) {
    constexpr double nearly_all = 0.95;
    std::vector<std::string> oddities;
    if (share < nearly_all) oddities.push_back(told_share(share));
    if (is_one_number(image.voxels))
        oddities.push_back(fmt::format("Every voxel of it is {}, so it is black in the report.",
                                       image.voxels.front()));
    return oddities;
}

PatientImage read_image_of(const Segmentation& segmentation, const std::string& path,
                           const char* which, const Settings& settings,
                           const ProgressSink& progress) {
    std::vector<std::string> oddities;
    PatientImage read{read_scalar_image(path, &oddities, progress), {}};
    const double share = share_shown(segmentation.labels, settings, read.image.grid);
    if (share == 0)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("cannot use '{}': it shows no voxel of the organs in the {}'s "
                                "labels; give the image that they were drawn on",
                                path, which));
    for (std::string& oddity : oddities_of(read.image, share))
        oddities.push_back(std::move(oddity));
    const auto& told = segmentation.warnings;  // labels and image often have one odd header
    for (const std::string& oddity : oddities)
        if (std::find(told.begin(), told.end(), oddity) == told.end())
            read.warnings.push_back(fmt::format("Image of the {}: {}", which, oddity));
    return read;
}

void check_name(const char* option, const std::string& path) {
    if (path.empty())
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{} names no file; give an image, or leave it out", option));
}

std::string counted(std::size_t count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

ImagePaths image_paths(const OptionValues& values, std::size_t num_label_volumes) {
    ImagePaths paths;
    if (values.is_given("reference_image")) paths.reference = values.text("reference_image");
    paths.targets = values.texts("target_image");
    check_name("--reference-image", paths.reference.value_or("-"));
    for (const std::string& path : paths.targets) check_name("--target-image", path);
    const std::size_t given = paths.targets.size();
    if (given == 0 || given == num_label_volumes) return paths;
    throw Error(
        ErrorCode::invalid_argument,
        num_label_volumes == 0
            ? "--target-image belongs to a label volume of the target; beside "
              "--target-surface and --target-points only --reference-image can be shown"
            : fmt::format("--target-image is given {} for {}; give it once for each target, "
                          "in the same order",
                          counted(given, "time"), counted(num_label_volumes, "target")));
}

GreyImages PatientImages::shown() const {
    return {reference ? &reference->image : nullptr, target ? &target->image : nullptr};
}

void PatientImages::add_warnings(RecoveryResult& result) const {
    for (const auto* read : {&reference, &target})
        if (*read)
            result.warnings.insert(result.warnings.end(), (*read)->warnings.begin(),
                                   (*read)->warnings.end());
}

std::optional<PatientImage> read_reference_image(const ImagePaths& paths, const Settings& settings,
                                                 const Segmentation& reference,
                                                 const ProgressSink& progress) {
    if (!paths.reference) return std::nullopt;
    return read_image_of(reference, *paths.reference, "reference", settings, progress);
}

std::optional<PatientImage> read_target_image(const ImagePaths& paths, std::size_t k,
                                              const Settings& settings, const Segmentation& target,
                                              const ProgressSink& progress) {
    if (paths.targets.empty()) return std::nullopt;
    return read_image_of(target, paths.targets.at(k), "target", settings, progress);
}

}  // namespace palpate
