// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/phantom/anatomy.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "host/imaging/parallel.hpp"

namespace palpate {
namespace {

Mat3 small_rotation(RandomNumbers& random, double largest_deg) {
    const double angle = random.uniform(-largest_deg, largest_deg) * 3.14159265358979 / 180;
    return Eigen::AngleAxisd(angle, random.direction()).toRotationMatrix();
}

void make_irregular(OrganShape& shape, RandomNumbers& random, double warp_mm) {
    shape.warp_mm = warp_mm;
    for (SmoothField& field : shape.warp) field = SmoothField(random, 32, 60);
}

/// A walnut: wider than deep, narrower towards the apex (inferior).
OrganShape make_prostate(RandomNumbers& random) {
    OrganShape shape;
    shape.semi_axes = {random.uniform(22.5, 26), random.uniform(18, 21), random.uniform(20, 24)};
    shape.taper = random.uniform(0.08, 0.2);
    shape.axes = small_rotation(random, 8);
    make_irregular(shape, random, random.uniform(0.8, 1.5));
    return shape;
}

OrganShape make_bladder(RandomNumbers& random) {
    OrganShape shape;
    shape.semi_axes = {random.uniform(24, 29), random.uniform(19, 23), random.uniform(15, 20)};
    shape.axes = small_rotation(random, 10);
    make_irregular(shape, random, random.uniform(0.8, 1.8));
    return shape;
}

/// A closed tube that follows the sacrum, its ends further back than its middle.
OrganShape make_rectum(RandomNumbers& random) {
    OrganShape shape;
    shape.semi_axes = {random.uniform(12, 15), random.uniform(10, 13), random.uniform(30, 35)};
    shape.roundness = 2.8;
    shape.bend_mm = random.uniform(2, 7);
    shape.axes = small_rotation(random, 6);
    make_irregular(shape, random, random.uniform(0.8, 1.5));
    return shape;
}

OrganShape make_bone(RandomNumbers& random) {
    OrganShape shape;
    shape.semi_axes = {random.uniform(8, 10), random.uniform(13, 17), random.uniform(14, 18)};
    shape.axes = small_rotation(random, 15);
    make_irregular(shape, random, random.uniform(0.6, 1.2));
    return shape;
}

/// An organ that is being put into its place, with its surface points.
struct Placed {
    OrganShape& shape;
    std::vector<Vec3> points;

    explicit Placed(OrganShape& organ) : shape(organ), points(surface_points(organ)) {}
    double gap_to(const Placed& other) const {
        return gap_between(shape, points, other.shape, other.points);
    }
    /// Lets `other`, which must stay where it is, dent this organ.
    void dent_by(const Placed& other, double gap_mm) {
        shape.dented_by = std::make_shared<const OrganShape>(other.shape);
        shape.dent_gap_mm = gap_mm;
        points = surface_points(shape);
    }
    /// Moves along `direction` until the distance to `other` is `gap_mm`; less than zero: an
    /// overlap.
    void place_at_gap(const Placed& other, const Vec3& direction, double gap_mm) {
        constexpr int most_steps = 14;
        constexpr double tolerance_mm = 0.05;
        for (int n = 0; n < most_steps; ++n) {
            const double missing = gap_mm - gap_to(other);
            if (std::abs(missing) < tolerance_mm) return;
            shape.centre += missing * direction;
        }
    }
    /// Moves along `direction` in steps until it is at least `gap_mm` away from `other`.
    void keep_away(const Placed& other, const Vec3& direction, double gap_mm) {
        constexpr double step_mm = 1.5;
        constexpr int most_steps = 20;
        for (int n = 0; n < most_steps && gap_to(other) < gap_mm; ++n) {
            shape.centre += step_mm * direction;
        }
    }
};

void place_organs(std::vector<Placed>& organs, RandomNumbers& random) {
    constexpr double smallest_gap_mm = 4.0;
    constexpr double smallest_bone_gap_mm = 8.0;
    const auto gap = [&] { return random.uniform(3.2, 6.0); };
    const auto overlap = [&] { return random.uniform(-6, -3); };

    const Vec3 up_and_forward{random.uniform(-0.08, 0.08), random.uniform(-0.45, -0.2), 1};
    organs[bladder].shape.centre = 42 * up_and_forward;
    organs[bladder].place_at_gap(organs[prostate], up_and_forward.normalized(), overlap());
    organs[bladder].dent_by(organs[prostate], gap());

    const double rectum_overlap = 0.7 * overlap();
    organs[rectum].shape.centre = Vec3{random.uniform(-3, 3), 36, random.uniform(-8, 0)};
    for (int n = 0; n < 3; ++n) {
        organs[rectum].place_at_gap(organs[prostate], Vec3(0, 1, 0), rectum_overlap);
        organs[rectum].keep_away(organs[bladder], Vec3(0, 0, -1), smallest_gap_mm);
    }
    organs[rectum].dent_by(organs[prostate], gap());

    for (const auto& [bone, side] : {std::pair{bone_left, 1.0}, std::pair{bone_right, -1.0}}) {
        const Vec3 outward(side, 0, 0);
        organs[bone].shape.centre = Vec3{side * 46, random.uniform(-8, 4), random.uniform(-6, 4)};
        organs[bone].place_at_gap(organs[prostate], outward, random.uniform(11, 15));
        organs[bone].keep_away(organs[bladder], outward, smallest_bone_gap_mm);
        organs[bone].keep_away(organs[rectum], outward, smallest_bone_gap_mm);
    }
}

void fit_box(PelvisAnatomy& anatomy, const std::vector<Placed>& organs, const Vec3& spacing) {
    constexpr double margin_mm = 21, multiple_mm = 6;
    Vec3 low = Vec3::Constant(1e9), high = -low;
    for (const Placed& organ : organs) {
        for (const Vec3& x : organ.points) {
            low = low.cwiseMin(organ.shape.centre + x);
            high = high.cwiseMax(organ.shape.centre + x);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double wanted = high[axis] - low[axis] + 2 * margin_mm;
        const double size = multiple_mm * std::ceil(wanted / multiple_mm);
        constexpr double rounding = 1e-6;
        anatomy.box_size[axis] = spacing[axis] * std::ceil(size / spacing[axis] - rounding);
    }
    anatomy.box_corner = 0.5 * (low + high) - 0.5 * anatomy.box_size;
}

}  // namespace

PelvisAnatomy make_anatomy(unsigned seed, const Vec3& spacing) {
    RandomNumbers random(0x70656c76ull * 1000003ull + seed);
    PelvisAnatomy anatomy;
    anatomy.organs = {make_prostate(random), make_bladder(random), make_rectum(random),
                      make_bone(random), make_bone(random)};
    std::vector<Placed> organs(anatomy.organs.begin(), anatomy.organs.end());
    place_organs(organs, random);
    fit_box(anatomy, organs, spacing);
    return anatomy;
}

ImageGrid grid_of_box(const PelvisAnatomy& anatomy, const Vec3& spacing) {
    ImageGrid grid;
    for (int axis = 0; axis < 3; ++axis) {
        grid.size[axis] = static_cast<Index>(std::lround(anatomy.box_size[axis] / spacing[axis]));
        grid.spacing[axis] = anatomy.box_size[axis] / grid.size[axis];
    }
    grid.origin = anatomy.box_corner + 0.5 * grid.spacing;
    return grid;
}

RegionImage fill_shapes(const PelvisAnatomy& anatomy, const ImageGrid& grid) {
    RegionImage image{grid, std::vector<std::uint8_t>(grid.num_voxels(), background_region)};
    parallel_for(grid.size[2], [&](Index begin, Index end) {
        for (Index organ = 0; organ < num_pelvis_organs; ++organ) {
            const OrganShape& shape = anatomy.organs[organ];
            const double reach = shape.reach();
            for (Index k = begin; k < end; ++k) {
                for (Index j = 0; j < grid.size[1]; ++j) {
                    for (Index i = 0; i < grid.size[0]; ++i) {
                        const Vec3 x = grid.to_point(Vec3(i, j, k));
                        if ((x - shape.centre).squaredNorm() > reach * reach) continue;
                        if (shape.value(x) >= 0) continue;
                        image.at(i, j, k) = static_cast<std::uint8_t>(first_organ_region + organ);
                    }
                }
            }
        }
    });
    return image;
}

}  // namespace palpate
