// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/picture_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/apps/simulate/obstacle_outline.hpp"

namespace palpate {
namespace {

constexpr double tallest_body = 330;  ///< SVG units

}  // namespace

PictureView PictureView::of(Formulation formulation) {
    if (formulation != Formulation::solid) return {};
    constexpr double turn = -0.55, tilt = 0.38;
    return {
        Vec3(std::cos(turn), std::sin(turn), 0),
        Vec3(-std::sin(tilt) * std::sin(turn), std::sin(tilt) * std::cos(turn), std::cos(tilt)),
        Vec3(std::cos(tilt) * std::sin(turn), -std::cos(tilt) * std::cos(turn), std::sin(tilt))};
}

PictureFrame::PictureFrame(const PictureView& view, bool is_mirrored, const std::vector<Vec3>& rest,
                           const std::vector<Vec3>& moved, const std::vector<Obstacle>& obstacles)
    : view_(view) {
    Place low(INFINITY, INFINITY), high(-INFINITY, -INFINITY);
    for (const auto* places : {&rest, &moved})
        for (const Vec3& place : *places) {
            const Place at = on_paper(place);
            low = low.cwiseMin(at);
            high = high.cwiseMax(at);
            if (is_mirrored) low.x() = std::min(low.x(), -at.x());
        }
    make_room(obstacles, low, high);
    centre_ = (low + high) / 2;
    const Place size = (high - low).cwiseMax(1e-9);
    pixels_per_mm_ = std::min((width - 2 * margin) / size.x(), tallest_body / size.y());
    height_ = 2 * margin + pixels_per_mm_ * size.y();
}

PictureFrame::Place PictureFrame::on_paper(const Vec3& place) const {
    return {place.dot(view_.right), place.dot(view_.up)};
}

/// So that a part of each ball and cylinder is seen, but the body stays large.
void PictureFrame::make_room(const std::vector<Obstacle>& obstacles, Place& low,
                             Place& high) const {
    constexpr double most_room = 0.3;
    const Place room = most_room * (high - low);
    const Place lowest = low - room, highest = high + room;
    for (const Obstacle& obstacle : obstacles) {
        const bool has_end = obstacle.shape == ObstacleShape::plane || has_edge(obstacle.shape);
        if (has_end || obstacle.is_hollow) continue;
        const Place at = on_paper(obstacle.place), reach = Place::Constant(obstacle.radius_mm);
        low = low.cwiseMin((at - reach).cwiseMax(lowest));
        high = high.cwiseMax((at + reach).cwiseMin(highest));
    }
}

std::string PictureFrame::point(const Vec3& place) const {
    const Place from_centre = pixels_per_mm_ * (on_paper(place) - centre_);
    return fmt::format("{:.1f} {:.1f}", width / 2 + from_centre.x(), height_ / 2 - from_centre.y());
}

std::string PictureFrame::circle(const Vec3& centre, double radius_mm) const {
    const double radius = pixels_per_mm_ * radius_mm;
    return fmt::format(
        "M{0}m{1:.1f} 0a{2:.1f} {2:.1f} 0 1 0 {3:.1f} 0a{2:.1f} {2:.1f} 0 1 0 {4:.1f} 0",
        point(centre), -radius, radius, 2 * radius, -2 * radius);
}

std::string PictureFrame::outline(const Obstacle& obstacle, double far_mm) const {
    const Vec3 along = obstacle.direction.normalized();
    const Vec3 across = Vec3::UnitZ().cross(along);
    std::string path;
    for (const double side : {1.0, -1.0}) {
        char step = 'M';
        for (const Eigen::Vector2d& at : outline_of(obstacle, far_mm)) {
            const Vec3 place = obstacle.place + side * at.x() * across + at.y() * along;
            path += step + point(place);
            step = 'L';
        }
    }
    return path;
}

std::string PictureFrame::outlines(const std::vector<Obstacle>& obstacles, double side) const {
    constexpr double far_mm = 1e4;
    const auto mirrored = [&](const Vec3& v) { return Vec3(side * v.x(), v.y(), v.z()); };
    const bool is_plane = view_.eye == Vec3::UnitZ();
    std::string path;
    for (const Obstacle& obstacle : obstacles) {
        const bool is_ball = obstacle.shape == ObstacleShape::sphere;
        if (is_ball || (is_plane && obstacle.shape == ObstacleShape::cylinder)) {
            path += circle(mirrored(obstacle.place), obstacle.radius_mm);
        } else if (is_plane && has_edge(obstacle.shape)) {
            // It is drawn on both sides of its axis, which is that of the mesh if there is one.
            if (side > 0) path += outline(obstacle, far_mm);
        } else if (is_plane) {
            const Vec3 along = Vec3::UnitZ().cross(obstacle.direction).normalized() * far_mm;
            path += fmt::format("M{}L{}", point(mirrored(obstacle.place - along)),
                                point(mirrored(obstacle.place + along)));
        }
    }
    return path;
}

}  // namespace palpate
