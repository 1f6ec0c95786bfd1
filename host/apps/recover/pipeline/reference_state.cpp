// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/reference_state.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/geometry/surfaces/extract.hpp"

namespace palpate {
namespace {

/// Newton's steps onto the contour. A surface of edges that are long against its curvature lies off
/// the contour that it was made of (1.3 mm on average with edges of 13 mm), which would turn what
/// is aligned by it.
constexpr int most_moves = 4;
constexpr double on_contour_mm = 1e-3;
/// Of the gradient of a distance: near the ridge of a thin organ it is smaller than one.
constexpr double least_slope = 0.3;

/// The point, where it does not come nearer to the contour or leaves the image.
Vec3 on_contour(const Vec3& corner, const DistanceMap& contour, const LabelField& field) {
    Vec3 point = corner, gradient;
    double distance = contour.value(point, gradient);
    const double far = std::abs(distance);
    for (int k = 0; k < most_moves && std::abs(distance) > on_contour_mm; ++k) {
        point -= distance / std::max(least_slope * least_slope, gradient.squaredNorm()) * gradient;
        distance = contour.value(point, gradient);
    }
    return std::abs(distance) < far && field.inside_box(point) ? point : corner;
}

/// Points on the contours of the fixed organs: the corners of their surfaces, caps left out.
std::vector<std::vector<Vec3>> fixed_points(const RegionSurface& surface, const LabelField& field,
                                            const Settings& settings) {
    const std::vector<DistanceMap> contours = maps_of_fixed(field, settings, own_margin_mm);
    std::vector<std::vector<Vec3>> points;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (!is_fixed(settings.organs[k])) continue;
        const Index region = first_organ_region + static_cast<Index>(k);
        const DistanceMap& contour = contours[points.size()];
        points.push_back(surface_of_region(surface, region, false).vertices);
        for (Vec3& point : points.back()) point = on_contour(point, contour, field);
    }
    return points;
}

/// Edge length that puts about a third of the wanted nodes on organ surfaces. With a node in the
/// middle of each edge too, nodes lie half as far apart as edges are long.
double edge_length_for(const RegionImage& image, Index num_nodes, ElementType element) {
    const auto& size = image.grid.size;
    const Vec3& h = image.grid.spacing;
    const std::array<double, 3> face{h[1] * h[2], h[0] * h[2], h[0] * h[1]};
    double area = 0;
    for (Index k = 1; k < size[2]; ++k) {
        for (Index j = 1; j < size[1]; ++j) {
            for (Index i = 1; i < size[0]; ++i) {
                const auto here = image.at(i, j, k);
                area += face[0] * (here != image.at(i - 1, j, k)) +
                        face[1] * (here != image.at(i, j - 1, k)) +
                        face[2] * (here != image.at(i, j, k - 1));
            }
        }
    }
    const double smooth_area = area / 1.5;  // voxel faces overrate a sphere by 3/2
    const double node_distance = std::sqrt(smooth_area / (0.866 * 0.35 * num_nodes));
    return element == ElementType::tet10 ? 2 * node_distance : node_distance;
}

}  // namespace

ReferenceState make_reference(LabelledState state, const RecoverOptions& options,
                              const ProgressSink& progress) {
    ReferenceState reference{std::move(state), 0, {}, {}};
    SurfaceOptions surface_options;
    surface_options.edge_length_mm =
        edge_length_for(reference.state.regions, options.mesher.num_nodes, options.element);
    surface_options.outer_edge_length_mm = 4.0 * surface_options.edge_length_mm;
    report_progress(progress, "surfaces", 0,
                    fmt::format("edge length {:.2f} mm", surface_options.edge_length_mm));
    const double wanted_mm = surface_options.edge_length_mm;
    std::string reason;
    reference.surface = extract_surfaces_finely(reference.state.regions, reference.state.field,
                                                surface_options, &reason, progress);
    reference.edge_length_mm = surface_options.edge_length_mm;
    if (!reason.empty())
        reference.state.warnings.push_back(
            fmt::format("The surfaces have edges of {:.2f} mm and volumes within {:.0f} % of the "
                        "voxels', not {:.2f} mm (for {} nodes) and {:.0f} %: {}",
                        reference.edge_length_mm, 100 * surface_options.volume_tolerance, wanted_mm,
                        options.mesher.num_nodes, 100 * SurfaceOptions{}.volume_tolerance, reason));
    reference.fixed_points =
        fixed_points(reference.surface, reference.state.field, options.settings);
    return reference;
}

}  // namespace palpate
