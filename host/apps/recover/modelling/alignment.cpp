// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/alignment.hpp"

#include <fmt/core.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int most_iterations = 50;
constexpr double far_apart_mm = 5.0;

Vec3 centroid_of_moving_organs(const RegionImage& image, const Settings& settings) {
    std::vector<bool> counts(256, false);
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        counts[first_organ_region + k] = settings.organs[k].role != Role::fixed;
    }
    Vec3 sum = Vec3::Zero();
    double voxels = 0;
    for (Index k = 0; k < image.grid.size[2]; ++k) {
        for (Index j = 0; j < image.grid.size[1]; ++j) {
            for (Index i = 0; i < image.grid.size[0]; ++i) {
                if (!counts[image.at(i, j, k)]) continue;
                sum += Vec3(i, j, k);
                voxels += 1;
            }
        }
    }
    return image.grid.to_point(sum / voxels);
}

RigidTransform moved_by(const RigidTransform& transform, const Vector6& step, const Vec3& pivot) {
    const Vec3 axis = step.head<3>();
    const double angle = axis.norm();
    const Mat3 turn =
        angle > 0 ? Mat3(Eigen::AngleAxisd(angle, axis / angle)) : Mat3(Mat3::Identity());
    return {turn * transform.rotation,
            turn * (transform.translation - pivot) + pivot + Vec3(step.tail<3>())};
}

double mean_distance(const std::vector<std::vector<Vec3>>& points,
                     const std::vector<DistanceMap>& maps, const RigidTransform& transform) {
    double sum = 0, count = 0;
    for (std::size_t s = 0; s < maps.size(); ++s) {
        for (const Vec3& point : points[s]) {
            sum += std::abs(maps[s].value(transform.apply(point)));
            count += 1;
        }
    }
    return count > 0 ? sum / count : 0.0;
}

}  // namespace

AlignMethod align_method_of(const std::string& name) {
    if (name == "auto") return AlignMethod::automatic;
    if (name == "fixed") return AlignMethod::fixed;
    if (name == "centroid") return AlignMethod::centroid;
    if (name == "none") return AlignMethod::none;
    throw Error(ErrorCode::invalid_argument,
                "there is no alignment '" + name + "'; there are auto, fixed, centroid, none");
}

RigidTransform align_centroids(const RegionImage& reference, const RegionImage& target,
                               const Settings& settings) {
    return {Mat3::Identity(), centroid_of_moving_organs(target, settings) -
                                  centroid_of_moving_organs(reference, settings)};
}

AlignmentResult align_surfaces(const std::vector<std::vector<Vec3>>& points,
                               const std::vector<DistanceMap>& target_maps,
                               const RigidTransform& start) {
    AlignmentResult result{"fixed", start, 0};
    Vec3 centre = Vec3::Zero();
    double count = 0;
    for (const auto& list : points) {
        for (const Vec3& point : list) centre += point;
        count += static_cast<double>(list.size());
    }
    if (count == 0) {
        throw Error(ErrorCode::input_unusable,
                    "there is no fixed organ surface inside the image to align by; use --align "
                    "centroid or --align none");
    }
    centre /= count;

    for (int k = 0; k < most_iterations; ++k) {
        const Vec3 pivot = result.reference_to_target.apply(centre);
        Matrix6 normal = 1e-6 * count * Matrix6::Identity();
        Vector6 right = Vector6::Zero();
        for (std::size_t s = 0; s < target_maps.size(); ++s) {
            for (const Vec3& point : points[s]) {
                const Vec3 y = result.reference_to_target.apply(point);
                Vec3 gradient;
                const double distance = target_maps[s].value(y, gradient);
                Vector6 row;
                row << (y - pivot).cross(gradient), gradient;
                const double weight = 1.0 / std::max(1.0, std::abs(distance));  // robust
                normal += weight * row * row.transpose();
                right -= weight * distance * row;
            }
        }
        const Vector6 step = normal.ldlt().solve(right);
        result.reference_to_target = moved_by(result.reference_to_target, step, pivot);
        if (step.tail<3>().norm() < 1e-5 && step.head<3>().norm() < 1e-7) break;
    }
    for (std::size_t s = 0; s < target_maps.size(); ++s) {
        for (const Vec3& point : points[s]) {
            Vec3 gradient;
            target_maps[s].value(result.reference_to_target.apply(point), gradient);
            const Vec3 normal = result.reference_to_target.rotation.transpose() * gradient;
            result.points.push_back({point, normal.normalized(), static_cast<Index>(s)});
        }
    }
    result.mean_distance_mm = mean_distance(points, target_maps, result.reference_to_target);
    if (!(result.mean_distance_mm < far_apart_mm)) {
        throw Error(
            ErrorCode::input_unusable,
            fmt::format("the fixed organs of the two images stay {:.1f} mm apart after rigid "
                        "alignment; check their labels, give --initial-transform, or use "
                        "--align centroid",
                        result.mean_distance_mm));
    }
    return result;
}

}  // namespace palpate
