// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/volume_job.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "solver/base/parallel.hpp"

namespace palpate {

namespace {

constexpr double samples_per_edge = 3;
constexpr double samples_per_voxel =
    1.6;  ///< linear interpolation cuts off what curves within a cell
constexpr double facet_volume_loss = 0.02;  ///< that facets inside a round organ may cost
constexpr double facet_distance_range[] = {0.02, 0.12};  ///< of the edge length
constexpr int calibrations = 4;
constexpr double max_values = 2e7;  ///< samples times regions: 80 MB

struct SampleGrid {
    std::array<Index, 3> size{};
    Vec3 spacing = Vec3::Ones();

    SampleGrid(const Vec3& box, double wanted) {
        for (int axis = 0; axis < 3; ++axis) {
            const double cells = std::max(1.0, std::ceil(box[axis] / wanted));
            size[axis] = static_cast<Index>(cells) + 1;
            spacing[axis] = box[axis] / cells;
        }
    }
    std::size_t count() const { return std::size_t(size[0]) * size[1] * size[2]; }
    std::array<Index, 3> index(std::size_t n) const {
        return {static_cast<Index>(n % size[0]), static_cast<Index>(n / size[0] % size[1]),
                static_cast<Index>(n / size[0] / size[1])};
    }
};

std::vector<Index> regions_in(const LabelField& field) {
    std::vector<Index> regions;
    for (Index r = 0; r < field.num_regions(); ++r)
        if (field.has_region(r)) regions.push_back(r);
    return regions;
}

std::vector<float> sampled(const LabelField& field, const std::vector<Index>& regions,
                           const SampleGrid& grid, const BoxFrame& frame) {
    std::vector<float> values(grid.count() * regions.size());
    parallel_ranges(grid.count(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            const auto i = grid.index(n);
            const Vec3 point = frame.to_lps(Vec3(i[0], i[1], i[2]).cwiseProduct(grid.spacing));
            for (std::size_t r = 0; r < regions.size(); ++r)
                values[n * regions.size() + r] = static_cast<float>(field.value(regions[r], point));
        }
    });
    return values;
}

/// Volumes and areas of the regions of least value, from the samples: a sample within half a cell
/// of an interface is shared between its two regions.
struct Extent {
    std::vector<double> volume, area;
};

Extent measured(const std::vector<float>& values, std::size_t num_regions, const SampleGrid& grid) {
    Extent extent{std::vector<double>(num_regions), std::vector<double>(num_regions)};
    const double cell = std::cbrt(grid.spacing.prod());
    for (std::size_t n = 0; n < grid.count(); ++n) {
        const float* value = values.data() + n * num_regions;
        std::size_t first = 0, second = num_regions;
        for (std::size_t r = 1; r < num_regions; ++r) {
            if (value[r] < value[first]) {
                second = first;
                first = r;
            } else if (second == num_regions || value[r] < value[second]) {
                second = r;
            }
        }
        const auto i = grid.index(n);
        double share = grid.spacing.prod();
        for (int axis = 0; axis < 3; ++axis)
            if (i[axis] == 0 || i[axis] == grid.size[axis] - 1) share /= 2;
        if (second == num_regions) {
            extent.volume[first] += share;
            continue;
        }
        const double distance = 0.5 * (value[second] - value[first]);
        const double part = std::min(1.0, 0.5 + distance / cell);
        extent.volume[first] += part * share;
        extent.volume[second] += (1 - part) * share;
        if (distance < 0.5 * cell) {
            extent.area[first] += share / cell;
            extent.area[second] += share / cell;
        }
    }
    return extent;
}

/// Moves the interfaces of each organ until it has the wanted volume. A change c of one field moves
/// the interface by c / 2.
void calibrate(std::vector<float>& values, const std::vector<Index>& regions,
               const std::vector<double>& wanted, const SampleGrid& grid) {
    for (int repeat = 0; repeat < calibrations; ++repeat) {
        const Extent extent = measured(values, regions.size(), grid);
        for (std::size_t r = 0; r < regions.size(); ++r) {
            if (regions[r] < first_organ_region || extent.area[r] <= 0) continue;
            const double most = grid.spacing.minCoeff();
            const double change =
                std::clamp(2 * (extent.volume[r] - wanted[r]) / extent.area[r], -most, most);
            for (std::size_t n = 0; n < grid.count(); ++n)
                values[n * regions.size() + r] += static_cast<float>(change);
        }
    }
}

/// Facets with their corners on a sphere of radius 3 volume / area lose about distance / radius of
/// its volume, if `distance` is the largest between facet and sphere.
std::vector<double> facet_distances(const Extent& extent, double edge_length_mm) {
    std::vector<double> distances;
    for (std::size_t r = 0; r < extent.volume.size(); ++r) {
        const double radius = 3 * extent.volume[r] / std::max(extent.area[r], 1e-9);
        distances.push_back(std::clamp(facet_volume_loss * radius,
                                       facet_distance_range[0] * edge_length_mm,
                                       facet_distance_range[1] * edge_length_mm));
    }
    return distances;
}

std::vector<double> volumes_of_voxels(const RegionImage& image, const std::vector<Index>& regions) {
    std::vector<double> by_number(256, 0.0), volumes;
    for (std::uint8_t region : image.voxels) by_number[region] += image.grid.voxel_volume();
    for (Index region : regions) volumes.push_back(by_number[region]);
    return volumes;
}

}  // namespace

BoxFrame::BoxFrame(const ImageGrid& grid)
    : axes(grid.direction), corner(grid.to_point(Vec3::Constant(-0.5))) {
    for (int axis = 0; axis < 3; ++axis) size[axis] = grid.size[axis] * grid.spacing[axis];
}

void add_sampled_field(const RegionImage& image, const LabelField& field, double edge_length_mm,
                       Exchange& job) {
    const BoxFrame frame(image.grid);
    const std::vector<Index> regions = regions_in(field);
    const double voxel = std::cbrt(image.grid.voxel_volume());
    const double wanted = std::min(edge_length_mm / samples_per_edge, voxel / samples_per_voxel);
    const double finest =
        std::cbrt(frame.size.prod() * static_cast<double>(regions.size()) / max_values);
    const SampleGrid grid(frame.size, std::max(wanted, finest));
    const std::vector<double> volumes = volumes_of_voxels(image, regions);
    std::vector<float> values = sampled(field, regions, grid, frame);
    calibrate(values, regions, volumes, grid);
    job.set("facet_distances",
            facet_distances(measured(values, regions.size(), grid), edge_length_mm));
    job.set("values", std::move(values));
    job.set("volumes", volumes);
    job.set("region_numbers", regions);
    job.set_rows("grid_size", std::vector<std::array<Index, 3>>{grid.size});
    job.set_points("grid_origin", {Vec3::Zero()});
    job.set_points("grid_spacing", {grid.spacing});
    job.set_points("box_low", {Vec3::Zero()});
    job.set_points("box_high", {frame.size});
}

}  // namespace palpate
