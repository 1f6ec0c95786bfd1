// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/label_grid.hpp"

#include <algorithm>
#include <limits>

#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

namespace {

constexpr double far_away = 1e30;
constexpr int max_regions = 64;
constexpr int bisections = 40;

}  // namespace

LabelGrid::LabelGrid(const VolumeJob& job) : job_(&job) {
    if (job.region_numbers.empty() || job.region_numbers.size() > max_regions)
        throw Error(ErrorCode::mesh_failed, "the volume mesher takes 1 to 64 regions");
}

bool LabelGrid::in_box(const Vec3& point) const {
    return (point.array() >= job_->box_low.array()).all() &&
           (point.array() <= job_->box_high.array()).all();
}

LabelGrid::Best LabelGrid::best_at(const Vec3& point) const {
    const auto& size = job_->size;
    const std::size_t num_regions = job_->region_numbers.size();
    std::array<Index, 3> i{};
    Vec3 t;
    for (int axis = 0; axis < 3; ++axis) {
        const double x = (point[axis] - job_->origin[axis]) / job_->spacing[axis];
        const double clamped = std::clamp(x, 0.0, size[axis] - 1.0);
        i[axis] = std::min(static_cast<Index>(clamped), size[axis] - 2);
        t[axis] = clamped - i[axis];
    }
    std::array<double, max_regions> value{};
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = (corner >> 1) & 1, dz = corner >> 2;
        const double weight =
            (dx ? t[0] : 1 - t[0]) * (dy ? t[1] : 1 - t[1]) * (dz ? t[2] : 1 - t[2]);
        const std::size_t sample =
            (i[0] + dx) + std::size_t(size[0]) * ((i[1] + dy) + std::size_t(size[1]) * (i[2] + dz));
        const float* values = job_->values.data() + sample * num_regions;
        for (std::size_t r = 0; r < num_regions; ++r) value[r] += weight * values[r];
    }
    Best best{0, far_away, far_away};
    for (std::size_t r = 0; r < num_regions; ++r) {
        if (value[r] < best.first)
            best = {job_->region_numbers[r], value[r], best.first};
        else
            best.second = std::min(best.second, value[r]);
    }
    return best;
}

Index LabelGrid::region_at(const Vec3& point) const {
    return in_box(point) ? best_at(point).region : 0;
}

double LabelGrid::interface_distance(const Vec3& point) const {
    const Best best = best_at(point);
    return 0.5 * (best.second - best.first);
}

Vec3 LabelGrid::sample_point(Index sample) const {
    const auto& size = job_->size;
    const Vec3 index(sample % size[0], sample / size[0] % size[1], sample / size[0] / size[1]);
    return job_->origin + index.cwiseProduct(job_->spacing);
}

std::vector<Index> LabelGrid::deepest_sample_of_parts() const {
    const auto& size = job_->size;
    const std::size_t num_regions = job_->region_numbers.size();
    const Index count = size[0] * size[1] * size[2];
    std::vector<Index> region(count);
    for (Index n = 0; n < count; ++n) {
        const float* values = job_->values.data() + std::size_t(n) * num_regions;
        region[n] = static_cast<Index>(std::min_element(values, values + num_regions) - values);
    }
    const auto depth = [&](Index n) {
        return -job_->values[std::size_t(n) * num_regions + region[n]];
    };
    const std::array<Index, 3> stride{1, size[0], size[0] * size[1]};
    std::vector<std::uint8_t> seen(count, 0);
    std::vector<Index> deepest, front;
    for (Index seed = 0; seed < count; ++seed) {
        if (seen[seed]) continue;
        Index best = seed;
        seen[seed] = 1;
        front.assign(1, seed);
        while (!front.empty()) {
            const Index n = front.back();
            front.pop_back();
            if (depth(n) > depth(best)) best = n;
            for (int axis = 0; axis < 3; ++axis) {
                const Index i = n / stride[axis] % size[axis];
                for (int step : {-1, 1}) {
                    const Index next = n + step * stride[axis];
                    if (i + step < 0 || i + step >= size[axis] || seen[next] ||
                        region[next] != region[seed])
                        continue;
                    seen[next] = 1;
                    front.push_back(next);
                }
            }
        }
        deepest.push_back(best);
    }
    return deepest;
}

/// Walks from a point along the directions of a cube's faces and corners to where the region
/// changes, and finds the place by bisection.
void LabelGrid::add_crossings(const Vec3& from, double distance,
                              std::vector<InterfacePoint>& points) const {
    const double step = job_->spacing.minCoeff();
    const Index region = region_at(from);
    for (int d = 0; d < 27; ++d) {
        const Vec3 direction(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1);
        if (direction.isZero()) continue;
        Vec3 inside = from, beyond = from;
        while (in_box(beyond) && region_at(beyond) == region) {
            inside = beyond;
            beyond += step * direction.normalized();
        }
        for (int i = 0; i < bisections; ++i) {
            const Vec3 middle = (inside + beyond) / 2;
            (region_at(middle) == region ? inside : beyond) = middle;
        }
        const Vec3 found = (inside + beyond) / 2;
        const bool is_near = std::any_of(
            points.begin(), points.end(),
            [&](const InterfacePoint& p) { return (p.point - found).norm() < distance; });
        if (region_at(beyond) != 0 && !is_near)
            points.push_back({found, {region, region_at(beyond)}});
    }
}

std::vector<InterfacePoint> LabelGrid::interface_points(double distance) const {
    std::vector<InterfacePoint> points;
    for (Index sample : deepest_sample_of_parts())
        if (region_at(sample_point(sample)) != 0)
            add_crossings(sample_point(sample), distance, points);
    return points;
}

}  // namespace palpate::mesh_tool
