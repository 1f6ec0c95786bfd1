// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/label_volumes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

/// Which grid axis stands for each patient axis, and whether it runs the other way.
struct AxisOrder {
    std::array<int, 3> axis{0, 1, 2};
    std::array<bool, 3> flipped{false, false, false};
    double tilt_deg = 0;
};

AxisOrder axis_order(const Mat3& direction) {
    AxisOrder best;
    double best_sum = -1;
    std::array<int, 3> p{0, 1, 2};
    do {
        double sum = 0;
        for (int a = 0; a < 3; ++a) sum += std::abs(direction(a, p[a]));
        if (sum > best_sum) {
            best_sum = sum;
            best.axis = p;
        }
    } while (std::next_permutation(p.begin(), p.end()));
    double smallest = 1;
    for (int a = 0; a < 3; ++a) {
        const double cosine = direction(a, best.axis[a]);
        best.flipped[a] = cosine < 0;
        smallest = std::min(smallest, std::abs(cosine));
    }
    best.tilt_deg = std::acos(std::clamp(smallest, 0.0, 1.0)) * 180 / std::numbers::pi;
    return best;
}

/// Inclusive index box on the image grid.
struct Box {
    std::array<Index, 3> low, high;
    bool empty() const { return low[0] > high[0]; }
};

using LabelTable = std::vector<std::uint8_t>;  ///< by file label

LabelTable label_table(const RecoveryResult& result, std::vector<Index>& regions) {
    LabelTable table(65536, 0);
    for (const RegionResult& r : result.regions) {
        if (r.role == Role::background || r.label <= 0 || r.label > 65535 || regions.size() > 253)
            continue;
        regions.push_back(r.region);
        table[r.label] = static_cast<std::uint8_t>(regions.size());
    }
    return table;
}

template <typename Visit>
void for_each_organ_voxel(const LabelImage& image, const LabelTable& table, const Visit& visit) {
    if (image.voxels.size() != image.grid.num_voxels()) return;
    const auto& n = image.grid.size;
    for (Index k = 0; k < n[2]; ++k)
        for (Index j = 0; j < n[1]; ++j)
            for (Index i = 0; i < n[0]; ++i)
                if (const std::uint8_t v = table[image.at(i, j, k)])
                    visit(std::array<Index, 3>{i, j, k}, v);
}

Box box_of_organs(const std::array<const LabelImage*, 3>& images, const LabelTable& table,
                  double margin_mm) {
    const auto& grid = images[0]->grid;
    Box box{grid.size, {-1, -1, -1}};
    for (const LabelImage* image : images) {
        if (image->grid.size != grid.size) continue;  // cannot be shown in the same box
        for_each_organ_voxel(*image, table, [&](const std::array<Index, 3>& at, std::uint8_t) {
            for (int a = 0; a < 3; ++a) {
                box.low[a] = std::min(box.low[a], at[a]);
                box.high[a] = std::max(box.high[a], at[a]);
            }
        });
    }
    if (box.empty()) return box;
    for (int a = 0; a < 3; ++a) {
        const auto margin = static_cast<Index>(std::ceil(margin_mm / grid.spacing[a]));
        box.low[a] = std::max<Index>(0, box.low[a] - margin);
        box.high[a] = std::min<Index>(grid.size[a] - 1, box.high[a] + margin);
    }
    return box;
}

/// From indices of the shown volume to indices of the image grid.
struct Sampling {
    AxisOrder order;
    Box box;
    Index step = 1;

    Index length(int a) const {
        const int g = order.axis[a];
        return (box.high[g] - box.low[g]) / step + 1;
    }
    std::array<Index, 3> to_grid(const std::array<Index, 3>& shown) const {
        std::array<Index, 3> at{};
        for (int a = 0; a < 3; ++a) {
            const int g = order.axis[a];
            at[g] = order.flipped[a] ? box.high[g] - step * shown[a] : box.low[g] + step * shown[a];
        }
        return at;
    }
    std::array<Index, 3> to_shown(const Vec3& at) const {
        std::array<Index, 3> shown{};
        for (int a = 0; a < 3; ++a) {
            const int g = order.axis[a];
            const double along = order.flipped[a] ? box.high[g] - at[g] : at[g] - box.low[g];
            shown[a] = std::clamp<Index>(std::lround(along / step), 0, length(a) - 1);
        }
        return shown;
    }
};

/// The voxels that are shown; all 0 for an image on another grid than the reference.
std::vector<std::uint8_t> sampled(const LabelImage& image, const ImageGrid& grid,
                                  const LabelTable& table, const Sampling& sampling,
                                  const LabelVolumes& shape) {
    std::vector<std::uint8_t> values(std::size_t(shape.size[0]) * shape.size[1] * shape.size[2]);
    if (image.grid.size != grid.size || image.voxels.size() != grid.num_voxels()) return values;
    for (Index k = 0; k < shape.size[2]; ++k)
        for (Index j = 0; j < shape.size[1]; ++j)
            for (Index i = 0; i < shape.size[0]; ++i) {
                const auto at = sampling.to_grid({i, j, k});
                values[shape.offset(i, j, k)] = table[image.at(at[0], at[1], at[2])];
            }
    return values;
}

/// Centroid, in voxel indices, of the unknown organs; of all organs that deform if there is none.
Vec3 centre_of_interest(const RecoveryResult& result, const LabelTable& table,
                        const std::vector<Index>& regions) {
    std::vector<bool> unknown(regions.size() + 1, false), moves(regions.size() + 1, false);
    for (const RegionResult& r : result.regions)
        for (std::size_t v = 0; v < regions.size(); ++v)
            if (regions[v] == r.region) {
                unknown[v + 1] = r.unknown;
                moves[v + 1] = r.role != Role::fixed;
            }
    for (const auto& wanted : {unknown, moves, std::vector<bool>(regions.size() + 1, true)}) {
        Vec3 sum = Vec3::Zero();
        double count = 0;
        for_each_organ_voxel(result.reference_labels, table, [&](const auto& at, std::uint8_t v) {
            if (!wanted[v]) return;
            sum += Vec3(at[0], at[1], at[2]);
            ++count;
        });
        if (count > 0) return sum / count;
    }
    return Vec3::Zero();
}

}  // namespace

LabelVolumes label_volumes(const RecoveryResult& result, std::size_t max_voxels, double margin_mm) {
    LabelVolumes volumes;
    const LabelImage& reference = result.reference_labels;
    const std::array<const LabelImage*, 3> images{&reference, &result.target_labels_aligned,
                                                  &result.warped_labels};

    const LabelTable table = label_table(result, volumes.regions);
    Sampling sampling{axis_order(reference.grid.direction),
                      box_of_organs(images, table, margin_mm)};
    if (sampling.box.empty()) return volumes;
    for (int a = 0; a < 3; ++a) volumes.size[a] = sampling.length(a);
    while (std::size_t(volumes.size[0]) * volumes.size[1] * volumes.size[2] > max_voxels) {
        ++sampling.step;
        for (int a = 0; a < 3; ++a) volumes.size[a] = sampling.length(a);
    }
    for (int a = 0; a < 3; ++a) {
        const int g = sampling.order.axis[a];
        volumes.spacing[a] = sampling.step * reference.grid.spacing[g];
        volumes.axes.col(a) =
            (sampling.order.flipped[a] ? -1 : 1) * reference.grid.direction.col(g);
    }
    const auto first = sampling.to_grid({0, 0, 0});
    volumes.origin = reference.grid.to_point(Vec3(first[0], first[1], first[2]));
    volumes.tilt_deg = sampling.order.tilt_deg;
    volumes.reference = sampled(*images[0], reference.grid, table, sampling, volumes);
    volumes.target = sampled(*images[1], reference.grid, table, sampling, volumes);
    volumes.warped = sampled(*images[2], reference.grid, table, sampling, volumes);
    volumes.centre = sampling.to_shown(centre_of_interest(result, table, volumes.regions));
    return volumes;
}

}  // namespace palpate
