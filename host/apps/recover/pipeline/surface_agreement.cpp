// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/surface_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "host/apps/recover/pipeline/observed_target.hpp"
#include "host/geometry/surfaces/surface_shape.hpp"

namespace palpate {
namespace {

constexpr double not_seen = std::numeric_limits<double>::quiet_NaN();

/// Distances at the vertices of a surface, with the area that each stands for.
struct Sampled {
    std::vector<double> mm, area;
    std::vector<std::uint8_t> seen;

    double seen_area() const {
        double sum = 0;
        for (std::size_t v = 0; v < area.size(); ++v) sum += seen[v] ? area[v] : 0;
        return sum;
    }
    double mean() const {
        double sum = 0;
        for (std::size_t v = 0; v < mm.size(); ++v) sum += seen[v] ? area[v] * std::abs(mm[v]) : 0;
        return seen_area() > 0 ? sum / seen_area() : not_seen;
    }
    double largest() const {
        double found = not_seen;
        for (std::size_t v = 0; v < mm.size(); ++v)
            if (seen[v]) found = std::fmax(found, std::abs(mm[v]));
        return found;
    }
    /// What the part `share` of the seen area does not exceed; NaN if nothing was seen.
    double percentile(double share) const {
        std::vector<std::size_t> order;
        for (std::size_t v = 0; v < mm.size(); ++v)
            if (seen[v] && area[v] > 0) order.push_back(v);
        if (order.empty()) return not_seen;
        std::ranges::sort(order, {}, [&](std::size_t v) { return std::abs(mm[v]); });
        double left = share * seen_area();
        for (const std::size_t v : order) {
            left -= area[v];
            if (left <= 0) return std::abs(mm[v]);
        }
        return std::abs(mm[order.back()]);
    }
};

Surface moved(const ObservedSurface& observed, const Eigen::VectorXd& displacement) {
    Surface surface = observed.surface;
    for (std::size_t v = 0; v < surface.vertices.size(); ++v)
        surface.vertices[v] += displacement.segment<3>(3 * observed.node_of[v]);
    return surface;
}

/// From the vertices of `target` to `surface`, but for those that lie beyond its rim.
Sampled distances_back(const Surface& target, Surface surface) {
    Sampled back;
    if (target.triangles.empty()) return back;
    const SurfaceShape shape(std::move(surface));
    back.area = vertex_areas(target);
    for (const Vec3& vertex : target.vertices) {
        const SurfaceShape::Distance distance = shape.distance(vertex);
        back.mm.push_back(distance.mm);
        back.seen.push_back(!distance.is_on_rim);
    }
    return back;
}

double larger(double a, double b) { return std::isfinite(b) ? std::max(a, b) : a; }

}  // namespace

void measure_agreement(const Recovered& found, std::size_t s, const TargetState& target,
                       SurfaceResult& result) {
    const ObservedSurface& observed = found.recovery.surfaces[s];
    const Surface after_surface = moved(observed, found.displacement);
    const std::size_t count = observed.node_of.size();
    const TargetShape* shape = found.target[s].get();
    const auto area = vertex_areas(observed.surface);
    Sampled before{std::vector(count, not_seen), area, std::vector<std::uint8_t>(count, 0)};
    Sampled after = before;
    const auto normals = vertex_normals(observed.surface);
    for (std::size_t v = 0; shape && v < count; ++v) {
        const Vec3& x = observed.surface.vertices[v];
        const ShapeDistance there = shape->measure(after_surface.vertices[v], normals[v]);
        before.mm[v] = shape->measure(x, normals[v]).mm;
        after.mm[v] = there.mm;
        before.seen[v] = after.seen[v] = there.is_seen && in_field_of_view(target, x);
    }
    const double all = std::accumulate(area.begin(), area.end(), 0.0);
    result.seen_share = all > 0 ? after.seen_area() / all : 0;
    result.mean_distance_mm_before = before.mean();
    result.max_distance_mm_before = before.largest();
    result.mean_distance_mm_after = after.mean();
    result.max_distance_mm_after = after.largest();
    const bool has_surface = result.target_kind == "labels" || result.target_kind == "surface";
    const Surface back_from = has_surface ? result.target : Surface{};
    result.hausdorff95_mm_before = larger(
        before.percentile(0.95), distances_back(back_from, observed.surface).percentile(0.95));
    result.hausdorff95_mm_after =
        larger(after.percentile(0.95), distances_back(back_from, after_surface).percentile(0.95));
    result.distance_before_mm = std::move(before.mm);
    result.distance_after_mm = std::move(after.mm);
    result.seen = std::move(after.seen);
}

}  // namespace palpate
