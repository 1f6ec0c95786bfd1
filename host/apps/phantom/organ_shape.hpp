// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "host/apps/phantom/random_numbers.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// Sum of a few plane waves: a smooth random field with values of about +-1 (at most 2).
class SmoothField {
public:
    SmoothField() = default;
    SmoothField(RandomNumbers& random, double shortest_mm, double longest_mm);
    double operator()(const Vec3& x) const;

private:
    struct Wave {
        Vec3 wave_vector;  ///< 1/mm
        double phase, amplitude;
    };
    std::vector<Wave> waves_;
};

/// An irregular closed organ: a (super)ellipsoid in its own axes, tapered, bent and deformed by a
/// smooth random warp. Lengths in mm.
struct OrganShape {
    Vec3 centre = Vec3::Zero();
    Mat3 axes = Mat3::Identity();  ///< columns: own axes in LPS
    Vec3 semi_axes = Vec3::Constant(10);
    double roundness = 2;  ///< 2: ellipsoid; larger: more like a tube with round ends
    double taper = 0;      ///< relative change of the cross section from middle to top
    double bend_mm = 0;    ///< how far both ends of the third axis lie back (own y)
    double warp_mm = 0;    ///< amplitude of the random warp
    std::array<SmoothField, 3> warp;
    /// Another organ (where it lies) that dents this one: the wall keeps `dent_gap_mm` away from it
    /// and follows its surface, as neighbouring organs do.
    std::shared_ptr<const OrganShape> dented_by;
    double dent_gap_mm = 0;

    /// About the signed distance (mm, negative inside), exact in sign, good near the surface.
    double value(const Vec3& x) const;
    /// Unit gradient of `value`: the outward normal on the surface.
    Vec3 normal(const Vec3& x) const;
    /// The same from differences over some millimetres: it turns slowly across the rim of a dent.
    Vec3 smooth_normal(const Vec3& x) const;
    /// A radius about the centre that holds the organ.
    double reach() const;

private:
    double undented_value(const Vec3& x) const;
};

/// Points on the surface, relative to the centre: one along each of `num_points` evenly spread rays
/// from the centre (the organs are star-shaped seen from there).
std::vector<Vec3> surface_points(const OrganShape& shape, int num_points = 1500);

/// Smallest distance (mm) between two organs given with their surface points; if they overlap,
/// minus the depth of a point of `a` in `b`. With 2,500 points on an organ of 60 cm^2 up to 0.2 mm
/// too large at a gap of 3 mm.
double gap_between(const OrganShape& a, const std::vector<Vec3>& points_a, const OrganShape& b,
                   const std::vector<Vec3>& points_b);

}  // namespace palpate
