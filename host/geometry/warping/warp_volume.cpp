// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/warp_volume.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "host/geometry/fields/cubic_bspline.hpp"
#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/warping/linear_value.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

/// out(y) = value(x) for every voxel centre y of `grid` whose x lies in `source`, else `fill`.
template <typename T, typename Value>
Warped<T> warp(const ImageGrid& source, const PointMap& back, const ImageGrid& grid, T fill,
               const Value& value) {
    Warped<T> out{{grid, std::vector<T>(grid.num_voxels(), fill)}, {}};
    std::atomic<std::size_t> beyond_field{0}, folded{0}, beyond_image{0};
    parallel_ranges(grid.size[1] * grid.size[2], 1, [&](std::size_t begin, std::size_t end) {
        OutsideCounts here;
        for (std::size_t row = begin; row < end; ++row) {
            const Index j = static_cast<Index>(row) % grid.size[1];
            const Index k = static_cast<Index>(row) / grid.size[1];
            for (Index i = 0; i < grid.size[0]; ++i) {
                const MovedPoint x = back.moved(grid.to_point(Vec3(i, j, k)));
                here.field += x.found && !x.inside;
                here.folded += !x.found;
                const bool in_image = is_inside(source, x.point);
                here.image += !in_image;
                if (in_image) out.image.at(i, j, k) = value(x.point);
            }
        }
        beyond_field += here.field;
        folded += here.folded;
        beyond_image += here.image;
    });
    out.outside = {beyond_field, folded, beyond_image};
    return out;
}

std::array<Index, 3> nearest_voxel(const ImageGrid& grid, const Vec3& index) {
    std::array<Index, 3> voxel{};
    for (int a = 0; a < 3; ++a) {
        const auto rounded = static_cast<Index>(std::floor(index[a] + 0.5));
        voxel[a] = std::clamp<Index>(rounded, 0, grid.size[a] - 1);
    }
    return voxel;
}

template <typename T>
T nearest_value(const Image<T>& image, const Vec3& point) {
    const auto [i, j, k] = nearest_voxel(image.grid, image.grid.to_index(point));
    return image.at(i, j, k);
}

/// Cubic B-spline through the voxels of an image, good up to its border: two voxels are mirrored
/// round it, the support that the spline needs there.
class Spline {
public:
    explicit Spline(const Image<float>& image) : grid_(image.grid) {
        for (int a = 0; a < 3; ++a) size_[a] = grid_.size[a] + 2 * pad;
        coefficients_.reserve(std::size_t(size_[0]) * size_[1] * size_[2]);
        for (Index k = 0; k < size_[2]; ++k)
            for (Index j = 0; j < size_[1]; ++j)
                for (Index i = 0; i < size_[0]; ++i)
                    coefficients_.push_back(
                        image.at(mirrored(i, 0), mirrored(j, 1), mirrored(k, 2)));
        to_bspline_coefficients(size_, coefficients_);
    }
    float operator()(const Vec3& point) const {
        Vec3 index = grid_.to_index(point);
        for (int a = 0; a < 3; ++a) index[a] = std::clamp(index[a], 0.0, grid_.size[a] - 1.0) + pad;
        return static_cast<float>(bspline_value(size_, coefficients_.data(), index));
    }

private:
    static constexpr Index pad = 2;

    Index mirrored(Index padded, int axis) const {
        const Index last = grid_.size[axis] - 1;
        Index i = std::abs(padded - pad);
        if (i > last) i = 2 * last - i;
        return std::clamp<Index>(i, 0, last);
    }
    ImageGrid grid_;
    std::array<Index, 3> size_{};
    std::vector<float> coefficients_;
};

/// The labels that occur, in order; region numbers are places in it.
std::vector<std::uint16_t> labels_in(const LabelImage& image) {
    std::vector<bool> there(65536, false);
    for (const std::uint16_t label : image.voxels) there[label] = true;
    std::vector<std::uint16_t> labels;
    for (std::size_t label = 0; label < there.size(); ++label) {
        if (there[label]) labels.push_back(static_cast<std::uint16_t>(label));
    }
    return labels;
}

LabelField field_of(const LabelImage& image, const std::vector<std::uint16_t>& labels) {
    if (labels.size() > 255) {
        throw Error(ErrorCode::unsupported,
                    "smooth interpolation is for up to 255 labels, and there are " +
                        std::to_string(labels.size()) + "; use --interpolation nearest");
    }
    std::vector<std::uint8_t> region(65536, 0);
    for (std::size_t r = 0; r < labels.size(); ++r) region[labels[r]] = std::uint8_t(r);
    RegionImage regions{image.grid, std::vector<std::uint8_t>(image.voxels.size())};
    std::transform(image.voxels.begin(), image.voxels.end(), regions.voxels.begin(),
                   [&](std::uint16_t label) { return region[label]; });
    return LabelField(regions, static_cast<Index>(labels.size()));
}

}  // namespace

Warped<float> warp_image(const Image<float>& image, const PointMap& back, const ImageGrid& grid,
                         Interpolation interpolation, float fill) {
    switch (interpolation) {
        case Interpolation::nearest:
            return warp(image.grid, back, grid, fill,
                        [&](const Vec3& x) { return nearest_value(image, x); });
        case Interpolation::linear:
            return warp(image.grid, back, grid, fill,
                        [&](const Vec3& x) { return linear_value<double>(image, x); });
        case Interpolation::cubic:
            return warp(image.grid, back, grid, fill, Spline(image));
        case Interpolation::smooth:
            break;
    }
    throw Error(ErrorCode::invalid_argument,
                "an image is interpolated nearest, linear or cubic; smooth is for labels");
}

Warped<std::uint16_t> warp_labels(const LabelImage& labels, const PointMap& back,
                                  const ImageGrid& grid, Interpolation interpolation) {
    constexpr std::uint16_t nothing = 0;
    if (interpolation == Interpolation::nearest) {
        return warp(labels.grid, back, grid, nothing,
                    [&](const Vec3& x) { return nearest_value(labels, x); });
    }
    if (interpolation != Interpolation::smooth) {
        throw Error(ErrorCode::invalid_argument, "labels are interpolated nearest or smooth");
    }
    const std::vector<std::uint16_t> names = labels_in(labels);
    const LabelField field = field_of(labels, names);
    return warp(labels.grid, back, grid, nothing,
                [&](const Vec3& x) { return names[field.region_at(x)]; });
}

}  // namespace palpate
