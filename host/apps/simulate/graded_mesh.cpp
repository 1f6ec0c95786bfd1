// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/graded_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/apps/simulate/smooth_curve.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double decay = 0.8;        ///< l over the edge's distance
constexpr double closeness = 1.35;   ///< of columns toward the edge
constexpr double least_angle = 0.2;  ///< sine of the corners of a cell

/// Ends of `count` cells from 0 to `length`, the first `first` long, each longer than the one
/// before by the same factor: first (q^n - 1) / (q - 1) = length.
std::vector<double> geometric_ends(double first, double length, int count) {
    const auto sum = [&](double q) {
        return std::abs(q - 1) < 1e-12 ? first * count : first * (std::pow(q, count) - 1) / (q - 1);
    };
    double low = 1e-3, high = 1e3;
    for (int step = 0; step < 200; ++step) {
        const double middle = std::sqrt(low * high);
        (sum(middle) > length ? high : low) = middle;
    }
    std::vector<double> ends{0};
    double size = first;
    for (int k = 0; k < count; ++k, size *= low) ends.push_back(ends.back() + size);
    ends.back() = length;
    return ends;
}

std::vector<double> divided(const std::vector<double>& ends, int parts) {
    std::vector<double> fine{ends.front()};
    for (std::size_t k = 1; k < ends.size(); ++k)
        for (int p = 1; p <= parts; ++p)
            fine.push_back(ends[k - 1] + (ends[k] - ends[k - 1]) * p / parts);
    return fine;
}

/// Each `stride`-th of the ends, and the last.
std::vector<double> thinned(const std::vector<double>& ends, int stride) {
    std::vector<double> kept;
    for (std::size_t k = 0; k < ends.size(); k += std::size_t(stride)) kept.push_back(ends[k]);
    if ((ends.size() - 1) % std::size_t(stride) != 0) kept.push_back(ends.back());
    return kept;
}

std::vector<double> lines_of(const GradedSettings& graded, const std::vector<double>& ends) {
    return divided(thinned(ends, graded.coarsen), graded.refine);
}

}  // namespace

std::vector<double> graded_columns(const GradedSettings& graded) {
    std::vector<double> ends;
    const double inner_mm = graded.face ? graded.face->hole_radius_mm : graded.edge_mm;
    for (int k = 0; k <= graded.columns_inside; ++k)
        ends.push_back(inner_mm * (1 - std::pow(1 - double(k) / graded.columns_inside, closeness)));
    if (graded.face)
        for (int k = 1; k <= graded.columns_edge; ++k)
            // x = R + e - e cos(k 90 deg / n), the angle counted from the bore
            ends.push_back(graded.edge_mm -
                           graded.face->edge_radius_mm *
                               std::cos(0.5 * std::numbers::pi * k / graded.columns_edge));
    ends.back() = graded.edge_mm;
    const double last = ends.back() - ends[ends.size() - 2];
    const double room = graded.width_mm - graded.edge_mm;
    for (const double x : geometric_ends(std::min(last, room / graded.columns_outside), room,
                                         graded.columns_outside))
        if (x > 0) ends.push_back(graded.edge_mm + x);
    return lines_of(graded, ends);
}

namespace {

/// h(x), level beyond the ends.
class SurfaceHeight {
public:
    explicit SurfaceHeight(const GradedSettings& graded)
        : is_level_(!has_surface(graded)),
          curve_(is_level_ ? std::vector<double>{0, 1, 2} : graded.surface_x_mm,
                 is_level_ ? std::vector<double>{0, 0, 0} : graded.surface_y_mm),
          first_(is_level_ ? 0 : graded.surface_x_mm.front()),
          last_(is_level_ ? 0 : graded.surface_x_mm.back()),
          face_(graded.face) {}
    double at(double x) const {
        const double y = is_level_ ? 0 : curve_.at(std::clamp(x, first_, last_));
        return face_ ? face_->below(x, y) : y;
    }

private:
    bool is_level_;
    SmoothCurve curve_;
    double first_, last_;
    std::optional<TubeFace> face_;
};

/// Sine of the angle at b from a to c.
double sine_at(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 to_a = a - b, to_c = c - b;
    return to_c.cross(to_a).z() / (to_a.norm() * to_c.norm());
}

void refuse_folds(const SolidMesh& mesh) {
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        const auto nodes = mesh.nodes_of(e);
        for (int k = 0; k < 4; ++k) {
            const Vec3 &a = mesh.nodes[nodes[(k + 3) % 4]], &b = mesh.nodes[nodes[k]],
                       &c = mesh.nodes[nodes[(k + 1) % 4]];
            if (!(sine_at(a, b, c) > least_angle))
                throw Error(ErrorCode::mesh_failed,
                            fmt::format("the surface is so steep near x = {:.3g} mm, y = {:.3g} mm "
                                        "that elements fold; smooth the profile, or take columns "
                                        "that are wider",
                                        b.x(), b.y()));
        }
    }
}

void check_graded(const GradedSettings& graded) {
    if (!(graded.edge_mm < graded.width_mm))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("a graded mesh needs its edge, at {:g} mm, below width_mm, {:g} mm",
                                graded.edge_mm, graded.width_mm));
    if (!(graded.finest_mm * graded.rows <= graded.depth_mm))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("{} rows from {:g} mm do not fit into a depth of {:g} mm; take "
                                "fewer, or finer ones",
                                graded.rows, graded.finest_mm, graded.depth_mm));
}

}  // namespace

// The rounded edge, centre (R + e, e), radius e, up to where it is half a right angle steep, from
// there its tangent up to the bore: a steeper step would fold cells.
double TubeFace::below(double x_mm, double y_mm) const {
    const double away = end_mm() - x_mm, steep = std::numbers::sqrt2 / 2 * edge_radius_mm;
    if (away <= 0) return std::min(y_mm, 0.0);
    if (away > edge_radius_mm * (1 + 1e-9)) return y_mm;
    if (away > steep) return std::min(y_mm, edge_radius_mm - steep + away - steep);
    return std::min(y_mm,
                    edge_radius_mm - std::sqrt(edge_radius_mm * edge_radius_mm - away * away));
}

bool has_surface(const GradedSettings& graded) { return !graded.surface_x_mm.empty(); }

SolidMesh graded_mesh(const GradedSettings& graded, Formulation formulation) {
    check_graded(graded);
    const std::vector<double> x = graded_columns(graded);
    const std::vector<double> d =
        lines_of(graded, geometric_ends(graded.finest_mm, graded.depth_mm, graded.rows));
    const SurfaceHeight height(graded);
    SolidMesh mesh;
    mesh.type = ElementType::quad4;
    mesh.formulation = formulation;
    for (const double depth : d)
        for (const double at : x)
            // y(x, d) = -d + h(x) exp(-d / l) (1 - d / depth)
            mesh.nodes.emplace_back(at,
                                    -depth + height.at(at) *
                                                 std::exp(-depth / (decay * graded.edge_mm)) *
                                                 (1 - depth / graded.depth_mm),
                                    0);
    const Index row = static_cast<Index>(x.size());
    for (Index j = 0; j + 1 < static_cast<Index>(d.size()); ++j)
        for (Index i = 0; i + 1 < row; ++i) {
            const Index above = row * j + i, below = above + row;
            mesh.elements.insert(mesh.elements.end(), {below, below + 1, above + 1, above});
        }
    mesh.region.assign(mesh.elements.size() / 4, 1);
    refuse_folds(mesh);
    return mesh;
}

std::vector<double> graded_surface(const GradedSettings& graded, const SolidMesh& mesh) {
    std::vector<double> surface(mesh.nodes.size(), 0.0);
    std::fill_n(surface.begin(), graded_columns(graded).size(), 1.0);
    return surface;
}

}  // namespace palpate
