// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/grey_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/geometry/warping/displacement_field.hpp"
#include "host/geometry/warping/linear_value.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr GreyWindow lung_window{-1350, 150}, soft_tissue_window{-160, 240};

template <typename Is>
double share_of(const std::vector<float>& values, const Is& is) {
    return double(std::count_if(values.begin(), values.end(), is)) / double(values.size());
}

double share_between(const std::vector<float>& values, float low, float high) {
    return share_of(values, [=](float v) { return v >= low && v <= high; });
}

bool are_whole_numbers(const std::vector<float>& values) {
    constexpr float rounding = 0.01f;  // of scale and intercept
    return share_of(values, [](float v) { return std::abs(v - std::round(v)) < rounding; }) > 0.99;
}

/// A peak at air, little between air and fat, and nearly all that is denser than fat soft tissue:
/// a CT that shows no air looks like other images and is not recognised.
bool is_in_hounsfield_units(const Image<float>& image) {
    const std::vector<float>& values = image.voxels;
    const double air = share_between(values, -1100, -900);
    const double between = share_between(values, -700, -300) / 2;  // of half as many numbers
    const double soft = share_between(values, -200, 300);
    const double hard = share_of(values, [](float v) { return v > 300; });
    return air > 0.01 && air > 2 * between && soft > 0.05 && soft > 2 * hard &&
           are_whole_numbers(values);
}

/// The number below which the given part of `values` lies; changes their order.
double quantile(std::vector<float>& values, double part) {
    const auto at = static_cast<std::ptrdiff_t>(part * double(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[std::size_t(at)];
}

/// The box of the label volumes, cut into other voxels.
struct Cutting {
    const LabelVolumes& volumes;
    Vec3 native = Vec3::Ones();  ///< mm: the image's voxels along the axes
    std::array<Index, 3> size{1, 1, 1};

    double length_mm(int a) const { return volumes.spacing[a] * volumes.size[a]; }
    double spacing_mm(int a) const { return length_mm(a) / size[a]; }
    std::size_t num_voxels() const { return std::size_t(size[0]) * size[1] * size[2]; }
    /// The point at (x, y, z) voxels from the corner of the box.
    Vec3 point(const Vec3& at) const {
        Vec3 along = -0.5 * volumes.spacing;
        for (int a = 0; a < 3; ++a) along[a] += at[a] * spacing_mm(a);
        return volumes.origin + volumes.axes * along;
    }
    /// How many points of a voxel are averaged along an axis.
    Index num_samples(int a) const {
        constexpr double almost = 0.05;  // not for rounding: as large as the image's own
        return std::clamp<Index>(Index(std::ceil(spacing_mm(a) / native[a] - almost)), 1, 8);
    }
};

Vec3 native_spacing(const ImageGrid& grid, const Mat3& axes) {
    Vec3 native;
    for (int a = 0; a < 3; ++a) {
        Index nearest = 0;
        (grid.direction.transpose() * axes.col(a)).cwiseAbs().maxCoeff(&nearest);
        native[a] = grid.spacing[nearest];
    }
    return native;
}

Cutting cutting_of(const ImageGrid& grid, const LabelVolumes& volumes,
                   const RigidTransform& to_image, std::size_t max_voxels) {
    Cutting cutting{volumes, native_spacing(grid, to_image.rotation * volumes.axes)};
    double finest = cutting.native.minCoeff();
    const auto cut = [&] {
        for (int a = 0; a < 3; ++a) {
            const double voxels = cutting.length_mm(a) / std::max(cutting.native[a], finest);
            cutting.size[a] = static_cast<Index>(std::clamp(std::round(voxels), 1.0, 16384.0));
        }
    };
    for (cut(); cutting.num_voxels() > std::max<std::size_t>(max_voxels, 1); cut()) finest *= 1.01;
    return cutting;
}

/// Mean of the image over one voxel; NaN where it says nothing.
float mean_over_voxel(const Image<float>& image, const Cutting& cutting,
                      const RigidTransform& to_image, const Vec3& voxel) {
    const std::array<Index, 3> n{cutting.num_samples(0), cutting.num_samples(1),
                                 cutting.num_samples(2)};
    double sum = 0;
    Index count = 0;
    for (Index c = 0; c < n[2]; ++c)
        for (Index b = 0; b < n[1]; ++b)
            for (Index a = 0; a < n[0]; ++a) {
                const Vec3 part((a + 0.5) / n[0], (b + 0.5) / n[1], (c + 0.5) / n[2]);
                const Vec3 x = to_image.apply(cutting.point(voxel + part));
                if (!is_inside(image.grid, x)) continue;
                sum += linear_value<double>(image, x);
                ++count;
            }
    return count ? float(sum / count) : std::numeric_limits<float>::quiet_NaN();
}

std::vector<float> resampled(const Image<float>& image, const Cutting& cutting,
                             const RigidTransform& to_image) {
    std::vector<float> values(cutting.num_voxels());
    const auto columns = cutting.size[0], rows = cutting.size[1], slices = cutting.size[2];
    parallel_ranges(std::size_t(rows) * slices, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
            for (Index i = 0; i < columns; ++i)
                values[row * columns + i] = mean_over_voxel(
                    image, cutting, to_image, Vec3(i, double(row % rows), double(row / rows)));
    });
    return values;
}

}  // namespace

std::uint8_t GreyWindow::grey(double number) const {
    if (!(white > black)) return number > black ? 255 : 0;
    return static_cast<std::uint8_t>(
        std::lround(255 * std::clamp((number - black) / (white - black), 0.0, 1.0)));
}

GreyWindow grey_window(const Image<float>& image, const std::vector<float>& shown) {
    std::vector<float> numbers;
    std::copy_if(shown.begin(), shown.end(), std::back_inserter(numbers),
                 [](float v) { return !std::isnan(v); });
    if (numbers.empty()) return {};
    if (is_in_hounsfield_units(image)) {
        const bool aerated = share_of(numbers, [](float v) { return v > -980 && v < -500; }) > 0.25;
        return aerated ? lung_window : soft_tissue_window;
    }
    const GreyWindow window{quantile(numbers, 0.01), quantile(numbers, 0.98)};
    if (window.white > window.black) return window;
    const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
    return {*low, *high};
}

GreyWindow grey_window(const Image<float>& image, const LabelVolumes& volumes,
                       const RigidTransform& to_image) {
    constexpr std::size_t enough_voxels = 300'000;
    const Cutting cutting = cutting_of(image.grid, volumes, to_image, enough_voxels);
    return grey_window(image, resampled(image, cutting, to_image));
}

void share_window(GreyWindow& a, GreyWindow& b) {
    constexpr double alike = 0.6;  // common part of both ranges
    const GreyWindow both{std::min(a.black, b.black), std::max(a.white, b.white)};
    const double common = std::min(a.white, b.white) - std::max(a.black, b.black);
    if (common >= alike * (both.white - both.black)) a = b = both;
}

GreyPicture grey_picture(const Image<float>& image, const LabelVolumes& volumes,
                         const RigidTransform& to_image, const GreyWindow& window,
                         std::size_t max_voxels) {
    GreyPicture picture;
    if (volumes.empty()) return picture;
    const Cutting cutting = cutting_of(image.grid, volumes, to_image, max_voxels);
    const std::vector<float> numbers = resampled(image, cutting, to_image);
    if (std::all_of(numbers.begin(), numbers.end(), [](float v) { return std::isnan(v); }))
        return picture;
    picture.size = cutting.size;
    picture.window = window;
    picture.voxels.reserve(numbers.size());
    for (const float number : numbers)
        picture.voxels.push_back(std::isnan(number) ? 0 : window.grey(number));
    return picture;
}

}  // namespace palpate
