// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solver/model/contact.hpp"

namespace palpate {

/// Axes of a picture: to the right, up, and toward the eye. A solid is seen obliquely from in front
/// and above, a plane mesh from z.
struct PictureView {
    Vec3 right = Vec3::UnitX(), up = Vec3::UnitY(), eye = Vec3::UnitZ();

    static PictureView of(Formulation formulation);
};

/// Where things are in a picture of `width` SVG units.
class PictureFrame {
public:
    static constexpr double width = 440, margin = 14;

    /// Round the body at rest and displaced (about an axis both halves), with some room for
    /// obstacles.
    PictureFrame(const PictureView& view, bool is_mirrored, const std::vector<Vec3>& rest,
                 const std::vector<Vec3>& moved, const std::vector<Obstacle>& obstacles);

    const PictureView& view() const { return view_; }
    double pixels_per_mm() const { return pixels_per_mm_; }
    double height() const { return height_; }
    /// "x y" in SVG units.
    std::string point(const Vec3& place) const;
    /// SVG path of the obstacles' outlines; seen obliquely only of spheres. `side`: -1 for the
    /// mirror image about an axis.
    std::string outlines(const std::vector<Obstacle>& obstacles, double side) const;

private:
    using Place = Eigen::Vector2d;
    Place on_paper(const Vec3& place) const;
    void make_room(const std::vector<Obstacle>& obstacles, Place& low, Place& high) const;
    std::string outline(const Obstacle& obstacle, double far_mm) const;
    std::string circle(const Vec3& centre, double radius_mm) const;

    PictureView view_;
    Place centre_;
    double pixels_per_mm_ = 1, height_ = 1;
};

}  // namespace palpate
