// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/meshing/volume_job.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/imaging/parallel.hpp"

namespace palpate {

namespace {

constexpr double samples_per_edge = 2;
constexpr double max_values = 4e7;  ///< samples times regions: 160 MB

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
    parallel_for(grid.count(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            const auto i = grid.index(n);
            const Vec3 point = frame.to_lps(Vec3(i[0], i[1], i[2]).cwiseProduct(grid.spacing));
            for (std::size_t r = 0; r < regions.size(); ++r)
                values[n * regions.size() + r] = static_cast<float>(field.value(regions[r], point));
        }
    });
    return values;
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
    const double wanted = edge_length_mm / samples_per_edge;
    const double finest =
        std::cbrt(frame.size.prod() * static_cast<double>(regions.size()) / max_values);
    const SampleGrid grid(frame.size, std::max(wanted, finest));
    job.set("values", sampled(field, regions, grid, frame));
    job.set("region_numbers", regions);
    job.set_rows("grid_size", std::vector<std::array<Index, 3>>{grid.size});
    job.set_points("grid_origin", {Vec3::Zero()});
    job.set_points("grid_spacing", {grid.spacing});
    job.set_points("box_low", {Vec3::Zero()});
    job.set_points("box_high", {frame.size});
}

}  // namespace palpate
