// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/surfaces/point_shape.hpp"

#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticPointLocator.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int plane_points = 8;

/// How far beside the closest points, in spacings, a point may still lie.
constexpr double reach = 1.5;

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
    std::vector<Vec3> nearest(const Vec3& point, int count) const {
        vtkNew<vtkIdList> found;
        locator->FindClosestNPoints(count, point.data(), found);
        std::vector<Vec3> points(found->GetNumberOfIds());
        for (std::size_t k = 0; k < points.size(); ++k) {
            data->GetPoint(found->GetId(static_cast<vtkIdType>(k)), points[k].data());
        }
        return points;
    }
};

PointShape::PointShape(std::vector<Vec3> points) : points_(std::move(points)) {
    if (points_.size() < plane_points) {
        throw Error(ErrorCode::input_unusable,
                    "a point cloud has " + std::to_string(points_.size()) +
                        " points; at least 8 are needed to see a surface in them");
    }
    tree_ = std::make_unique<Tree>(points_);
    std::vector<double> distance;
    for (const Vec3& point : points_) {
        distance.push_back((tree_->nearest(point, 2).back() - point).norm());
    }
    std::nth_element(distance.begin(), distance.begin() + distance.size() / 2, distance.end());
    spacing_mm_ = distance[distance.size() / 2];
}

PointShape::~PointShape() = default;

ShapeDistance PointShape::measure(const Vec3& point, const Vec3& facing) const {
    const std::vector<Vec3> near = tree_->nearest(point, plane_points);
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : near) centre += x / plane_points;
    Mat3 scatter = Mat3::Zero();
    for (const Vec3& x : near) scatter += (x - centre) * (x - centre).transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(scatter);
    Vec3 normal = eigen.eigenvectors().col(0);
    if (normal.dot(facing) < 0) normal = -normal;
    const double distance = normal.dot(point - centre);
    const Vec3 foot = point - distance * normal;
    double beside = std::numeric_limits<double>::max();
    for (const Vec3& x : near) beside = std::min(beside, (x - foot).norm());
    const double spread = std::sqrt(scatter.trace() / plane_points);
    return {distance, normal, beside < reach * spacing_mm_ && (foot - centre).norm() < spread};
}

}  // namespace palpate
