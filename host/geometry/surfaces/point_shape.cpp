// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/point_shape.hpp"

#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticPointLocator.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int least_points = 8, least_plane_points = 16, most_plane_points = 48;

/// How far beside the closest points, in spacings, a point may still lie: points that lie at random
/// leave gaps of two spacings.
constexpr double reach = 3;

constexpr double same_point_mm = 1e-6;

/// A point is a stray if its neighbours are this many times farther away than usual.
constexpr double stray_distance = 4.0;

/// Of a plane, in standard deviations of the noise: wide enough for its direction to be good to
/// about 10 degrees.
constexpr double plane_radius = 4.0;

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

void check_count(std::size_t count) {
    if (count >= least_points) return;
    throw Error(ErrorCode::input_unusable,
                "a point cloud has " + std::to_string(count) +
                    " points; at least 8 are needed to see a surface in them");
}

}  // namespace

struct PointShape::Tree {
    vtkNew<vtkPolyData> data;
    vtkNew<vtkStaticPointLocator> locator;

    explicit Tree(const std::vector<Vec3>& points) {
        vtkNew<vtkPoints> list;
        list->SetDataTypeToDouble();
        for (const Vec3& x : points) list->InsertNextPoint(x.data());
        data->SetPoints(list);
        locator->SetDataSet(data);
        locator->BuildLocator();
    }
    /// Numbers of the closest points, the closest first.
    std::vector<Index> nearest(const Vec3& point, int count) const {
        vtkNew<vtkIdList> found;
        locator->FindClosestNPoints(count, point.data(), found);
        return {found->begin(), found->end()};
    }
};

struct PointShape::Plane {
    std::vector<Index> points;  ///< of the cloud
    Vec3 centre, normal;        ///< of either sign
    double spread_mm;           ///< weighted root mean square distance of them from the centre
};

PointShape::PointShape(std::vector<Vec3> points, const Outward& outward, double noise_mm)
    : points_(std::move(points)), plane_points_(least_points) {
    check_count(points_.size());
    average(std::max(2 * noise_mm, same_point_mm));
    drop_strays();
    const double disc = std::numbers::pi * std::pow(plane_radius * noise_mm / spacing_mm_, 2);
    const double wanted = std::clamp(disc, double(least_plane_points), double(most_plane_points));
    plane_points_ = static_cast<int>(std::min(wanted, static_cast<double>(points_.size())));
    orient(outward);
}

PointShape::~PointShape() = default;

/// One point, their mean, for all in a cell of a grid.
void PointShape::average(double cell_mm) {
    std::map<std::array<long, 3>, std::pair<Vec3, int>> cells;
    for (const Vec3& point : points_) {
        std::array<long, 3> at;
        for (int a = 0; a < 3; ++a) at[a] = std::lround(point[a] / cell_mm);
        auto& [sum, count] = cells.try_emplace(at, Vec3::Zero(), 0).first->second;
        sum += point;
        ++count;
    }
    points_.clear();
    for (const auto& [at, cell] : cells) {
        points_.push_back(cell.first / cell.second);
        counts_.push_back(cell.second);
    }
}

/// Sets the tree and the spacing, too.
void PointShape::drop_strays() {
    check_count(points_.size());
    tree_ = std::make_unique<Tree>(points_);
    std::vector<double> first, last;
    for (const Vec3& point : points_) {
        const auto near = tree_->nearest(point, least_points);
        first.push_back((points_[near[1]] - point).norm());
        last.push_back((points_[near.back()] - point).norm());
    }
    spacing_mm_ = median(first);
    const double limit = stray_distance * median(last);
    std::vector<Vec3> kept;
    std::vector<double> counts;
    for (std::size_t k = 0; k < points_.size(); ++k) {
        if (last[k] > limit) continue;
        kept.push_back(points_[k]);
        counts.push_back(counts_[k]);
    }
    if (kept.size() == points_.size()) return;
    check_count(kept.size());
    points_ = std::move(kept);
    counts_ = std::move(counts);
    tree_ = std::make_unique<Tree>(points_);
}

/// Weights: counts times (R^2 - d^2)^2 at distances d from `point`, R that of the last: a point
/// joins and leaves with none, so the plane has no jumps. Seen from beside the surface they depend
/// on distances along it alone.
std::vector<double> PointShape::shares_of(const std::vector<Index>& near, const Vec3& point) const {
    const double last = (points_[near.back()] - point).squaredNorm();
    std::vector<double> share;
    double sum = 0;
    for (const Index k : near) {
        const double inside = last - (points_[k] - point).squaredNorm();
        share.push_back(counts_[k] * (inside * inside + 1e-12));
        sum += share.back();
    }
    for (double& each : share) each /= sum;
    return share;
}

PointShape::Plane PointShape::plane_at(const Vec3& point) const {
    Plane plane{tree_->nearest(point, plane_points_), Vec3::Zero(), Vec3::Zero(), 0};
    const auto share = shares_of(plane.points, point);
    for (std::size_t i = 0; i < share.size(); ++i) {
        plane.centre += share[i] * points_[plane.points[i]];
    }
    Mat3 scatter = Mat3::Zero();
    for (std::size_t i = 0; i < share.size(); ++i) {
        const Vec3 offset = points_[plane.points[i]] - plane.centre;
        scatter += share[i] * offset * offset.transpose();
    }
    plane.normal = Eigen::SelfAdjointEigenSolver<Mat3>(scatter).eigenvectors().col(0);
    plane.spread_mm = std::sqrt(scatter.trace());
    return plane;
}

/// Neighbours agree, those first whose planes are most alike.
void PointShape::orient(const Outward& outward) {
    const Index count = static_cast<Index>(points_.size());
    std::vector<Plane> planes;
    std::vector<double> votes;
    for (const Vec3& point : points_) {
        planes.push_back(plane_at(point));
        votes.push_back(planes.back().normal.dot(outward(point).normalized()));
    }
    struct Edge {
        double alike;
        Index a, b;
        bool opposed;
    };
    std::vector<Edge> edges;
    for (Index a = 0; a < count; ++a) {
        for (int k = 1; k < least_points; ++k) {
            const Index b = planes[a].points[k];
            const double cosine = planes[a].normal.dot(planes[b].normal);
            edges.push_back({std::abs(cosine), a, b, cosine < 0});
        }
    }
    std::stable_sort(edges.begin(), edges.end(),
                     [](const Edge& x, const Edge& y) { return x.alike > y.alike; });
    OutwardVote vote(count);
    for (const Edge& edge : edges) vote.join(edge.a, edge.b, edge.opposed);
    const auto turned = vote.turned(votes);
    for (Index k = 0; k < count; ++k) {
        normals_.push_back(turned[k] ? -planes[k].normal : planes[k].normal);
    }
}

ShapeDistance PointShape::measure(const Vec3& point, const Vec3& facing) const {
    Plane plane = plane_at(point);
    double agree = 0;
    for (const Index k : plane.points) agree += normals_[k].dot(plane.normal);
    if (agree < 0) plane.normal = -plane.normal;
    const double distance = plane.normal.dot(point - plane.centre);
    const Vec3 foot = point - distance * plane.normal;
    double beside = std::numeric_limits<double>::max();
    for (const Index k : plane.points) beside = std::min(beside, (points_[k] - foot).norm());
    const bool is_over =
        beside < reach * spacing_mm_ && (foot - plane.centre).norm() < plane.spread_mm;
    return {distance, plane.normal, is_over && face_alike(plane.normal, facing), plane.normal};
}

}  // namespace palpate
