// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/label_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "host/geometry/fields/cubic_bspline.hpp"
#include "host/geometry/fields/signed_distance.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr double padding_mm = 6;         // beyond the image; further out the field is constant
constexpr double stored_margin_mm = 10;  // round a region; further out the distance is added
constexpr Index min_margin_voxels = 3;   // support of the spline and one sample more
constexpr double absent_mm = 1e6;
constexpr std::uint8_t near_interface = 255;

Index margin_voxels(double margin_mm, double spacing) {
    return std::max(min_margin_voxels, static_cast<Index>(std::ceil(margin_mm / spacing)));
}

void check(const RegionImage& image, Index num_regions) {
    if (image.voxels.empty() || image.voxels.size() != image.grid.num_voxels()) {
        throw Error(ErrorCode::invalid_argument, "a label field needs an image with voxels");
    }
    const auto highest = *std::max_element(image.voxels.begin(), image.voxels.end());
    if (highest >= num_regions) {
        throw Error(ErrorCode::invalid_argument,
                    "the region image holds region " + std::to_string(highest) + " but only " +
                        std::to_string(num_regions) + " regions were announced");
    }
}

/// Marks what lies within `reach` of another value along one line; a line goes on beyond its ends.
void mark_ends_of_runs(std::uint8_t* line, Index length, std::size_t stride, Index reach) {
    for (Index first = 0, end = 0; first < length; first = end) {
        const std::uint8_t value = line[first * stride];
        while (end < length && line[end * stride] == value) ++end;
        const Index deep_first = first == 0 ? 0 : std::min(first + reach, end);
        const Index deep_end = end == length ? length : std::max(end - reach, deep_first);
        for (Index i = first; i < deep_first; ++i) line[i * stride] = near_interface;
        for (Index i = deep_end; i < end; ++i) line[i * stride] = near_interface;
    }
}

}  // namespace

LabelField::LabelField(const RegionImage& image, Index num_regions, double smoothing_mm)
    : grid_(image.grid),
      smoothing_mm_(smoothing_mm > 0 ? smoothing_mm : 0.9 * std::cbrt(image.grid.voxel_volume())),
      boxes_(num_regions),
      coefficients_(num_regions) {
    check(image, num_regions);
    find_boxes(image);
    std::array<Index, 3> pad;
    for (int a = 0; a < 3; ++a) pad[a] = margin_voxels(padding_mm, grid_.spacing[a]);
    for (Index region = 0; region < num_regions; ++region) {
        if (boxes_[region].last[0] < 0) continue;
        store_around(region, pad);
        build_region(image, region);
    }
    find_deep_voxels(image);
}

void LabelField::find_boxes(const RegionImage& image) {
    for (Box& box : boxes_) box.first = grid_.size;
    for (Index k = 0; k < grid_.size[2]; ++k) {
        for (Index j = 0; j < grid_.size[1]; ++j) {
            for (Index i = 0; i < grid_.size[0]; ++i) {
                Box& box = boxes_[image.at(i, j, k)];
                const std::array<Index, 3> voxel{i, j, k};
                for (int a = 0; a < 3; ++a) {
                    box.first[a] = std::min(box.first[a], voxel[a]);
                    box.last[a] = std::max(box.last[a], voxel[a]);
                }
            }
        }
    }
}

void LabelField::store_around(Index region, const std::array<Index, 3>& pad) {
    Box& box = boxes_[region];
    for (int a = 0; a < 3; ++a) {
        const Index margin = margin_voxels(stored_margin_mm + 4 * smoothing_mm_, grid_.spacing[a]);
        const Index last_voxel = grid_.size[a] - 1;
        const bool at_low = box.first[a] == 0, at_high = box.last[a] == last_voxel;
        // A region in the border slice runs on to the end of the padding.
        const Index low = std::max(-pad[a], at_low ? -pad[a] : box.first[a] - margin);
        const Index high =
            std::min(last_voxel + pad[a], at_high ? last_voxel + pad[a] : box.last[a] + margin);
        box.cut = box.cut || at_low || at_high;
        box.low[a] = low;
        box.size[a] = high - low + 1;
        box.is_image_end[a] = {low == -pad[a], high == last_voxel + pad[a]};
    }
}

void LabelField::build_region(const RegionImage& image, Index region) {
    const Box& box = boxes_[region];
    std::vector<std::uint8_t> mask(std::size_t(box.size[0]) * box.size[1] * box.size[2]);
    auto inside = [&](Index stored, int axis) {
        return std::clamp(stored + box.low[axis], Index(0), grid_.size[axis] - 1);
    };
    parallel_ranges(box.size[2], 1, [&](std::size_t begin, std::size_t end) {
        for (Index k = Index(begin); k < Index(end); ++k) {
            std::size_t out = std::size_t(k) * box.size[0] * box.size[1];
            for (Index j = 0; j < box.size[1]; ++j) {
                const std::uint8_t* row = &image.at(0, inside(j, 1), inside(k, 2));
                for (Index i = 0; i < box.size[0]; ++i) mask[out++] = row[inside(i, 0)] == region;
            }
        }
    });
    coefficients_[region] = signed_distance(box.size, grid_.spacing, mask);
    smooth_without_shrinking(box.size, grid_.spacing, smoothing_mm_, coefficients_[region]);
    to_bspline_coefficients(box.size, coefficients_[region]);
}

/// Smoothing moves an interface by far less than three of its standard deviations.
void LabelField::find_deep_voxels(const RegionImage& image) {
    deep_ = image.voxels;
    const std::array<std::size_t, 3> stride{1, std::size_t(grid_.size[0]),
                                            std::size_t(grid_.size[0]) * grid_.size[1]};
    for (int axis = 0; axis < 3; ++axis) {
        const Index reach = static_cast<Index>(std::ceil(3 * smoothing_mm_ / grid_.spacing[axis]));
        const int inner = axis == 0 ? 1 : 0, outer = 3 - axis - inner;
        parallel_ranges(grid_.size[outer], 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b) {
                for (Index a = 0; a < grid_.size[inner]; ++a) {
                    mark_ends_of_runs(deep_.data() + b * stride[outer] + a * stride[inner],
                                      grid_.size[axis], stride[axis], reach);
                }
            }
        });
    }
}

Vec3 LabelField::clamped_index(const Box& box, const Vec3& point, Vec3& beyond,
                               std::array<bool, 3>& held) const {
    const Vec3 index = grid_.to_index(point) - Vec3(box.low[0], box.low[1], box.low[2]);
    const Vec3 clamped = clamped_to_support(box.size, index);
    for (int a = 0; a < 3; ++a) {
        const double offset = index[a] - clamped[a];
        held[a] = offset != 0;
        const bool continues = held[a] && box.is_image_end[a][offset > 0];
        beyond[a] = continues ? 0.0 : offset * grid_.spacing[a];
    }
    return clamped;
}

double LabelField::value(Index region, const Vec3& point) const {
    if (!has_region(region)) return absent_mm;
    Vec3 beyond;
    std::array<bool, 3> held;
    const Vec3 index = clamped_index(boxes_[region], point, beyond, held);
    return bspline_value(boxes_[region].size, coefficients_[region].data(), index) + beyond.norm();
}

double LabelField::lower_bound(Index region, const Vec3& point) const {
    if (!has_region(region)) return std::numeric_limits<double>::infinity();
    Vec3 beyond;
    std::array<bool, 3> held;
    clamped_index(boxes_[region], point, beyond, held);
    const double distance = beyond.norm();
    // The stored samples end `stored_margin_mm` and more from the region.
    return distance > 0 ? distance + 0.5 * stored_margin_mm : -absent_mm;
}

double LabelField::value(Index region, const Vec3& point, Vec3& gradient) const {
    gradient.setZero();
    if (!has_region(region)) return absent_mm;
    Vec3 beyond, slope;
    std::array<bool, 3> held;
    const Vec3 index = clamped_index(boxes_[region], point, beyond, held);
    const double value =
        bspline_value(boxes_[region].size, coefficients_[region].data(), index, &slope);
    const double distance = beyond.norm();
    for (int a = 0; a < 3; ++a) slope[a] = held[a] ? 0.0 : slope[a] / grid_.spacing[a];
    if (distance > 0) slope += beyond / distance;
    gradient = grid_.direction * slope;
    return value + distance;
}

double LabelField::interface_value(Index a, Index b, const Vec3& point, Vec3* gradient) const {
    if (!gradient) return 0.5 * (value(a, point) - value(b, point));
    Vec3 gradient_a, gradient_b;
    const double difference = value(a, point, gradient_a) - value(b, point, gradient_b);
    *gradient = 0.5 * (gradient_a - gradient_b);
    return 0.5 * difference;
}

Index LabelField::nearest_other(Index region, const Vec3& point) const {
    Index best = region == 0 ? 1 : 0;
    double smallest = std::numeric_limits<double>::infinity();
    for (Index other = 0; other < num_regions(); ++other) {
        if (other == region || lower_bound(other, point) >= smallest) continue;
        const double distance = value(other, point);
        if (distance < smallest) {
            smallest = distance;
            best = other;
        }
    }
    return best;
}

Index LabelField::region_at(const Vec3& point) const {
    if (inside_box(point)) {
        const Vec3 index = grid_.to_index(point).array().round();
        const std::uint8_t deep =
            deep_[grid_.offset(std::clamp<Index>(Index(index[0]), 0, grid_.size[0] - 1),
                               std::clamp<Index>(Index(index[1]), 0, grid_.size[1] - 1),
                               std::clamp<Index>(Index(index[2]), 0, grid_.size[2] - 1))];
        if (deep != near_interface) return deep;
    }
    Index best = 0;
    double smallest = std::numeric_limits<double>::infinity();
    for (Index region = 0; region < num_regions(); ++region) {
        if (lower_bound(region, point) >= smallest) continue;
        const double distance = value(region, point);
        if (distance < smallest) {
            smallest = distance;
            best = region;
        }
    }
    return best;
}

bool LabelField::inside_box(const Vec3& point) const {
    const Vec3 index = grid_.to_index(point);
    for (int a = 0; a < 3; ++a) {
        if (index[a] < -0.5 || index[a] > grid_.size[a] - 0.5) return false;
    }
    return true;
}

}  // namespace palpate
