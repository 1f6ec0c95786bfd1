// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/anatomy.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr std::array<std::pair<AnatomyFamily, const char*>, 6> anatomy_names{
    {{AnatomyFamily::usual, "usual"},
     {AnatomyFamily::round, "round"},
     {AnatomyFamily::flat, "flat"},
     {AnatomyFamily::touching, "touching"},
     {AnatomyFamily::cut, "cut"},
     {AnatomyFamily::drawn, "drawn"}}};

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

/// Changes prostate and bladder before they are put into their places.
void shape_as(AnatomyFamily family, PelvisAnatomy& anatomy) {
    Vec3 &of_prostate = anatomy.organs[prostate].semi_axes,
         &of_bladder = anatomy.organs[bladder].semi_axes;
    if (family == AnatomyFamily::round) {
        of_prostate = Vec3::Constant(std::cbrt(of_prostate.prod()));
        of_bladder = Vec3::Constant(std::cbrt(of_bladder.prod()));
        anatomy.organs[prostate].taper = 0;
    } else if (family == AnatomyFamily::flat) {
        of_prostate = of_prostate.cwiseProduct(Vec3(1.2, 0.6, 1.1));
        of_bladder = of_bladder.cwiseProduct(Vec3(1.1, 1.1, 0.6));
    }
}

void place_organs(std::vector<Placed>& organs, RandomNumbers& random, AnatomyFamily family) {
    constexpr double smallest_gap_mm = 4.0;
    constexpr double smallest_bone_gap_mm = 8.0;
    const bool is_touching = family == AnatomyFamily::touching;
    const auto gap = [&] { return is_touching ? 0.0 : random.uniform(3.2, 6.0); };
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
    anatomy.image_corner = anatomy.box_corner;
    anatomy.image_size = anatomy.box_size;
}

/// The images end within bladder (above) and rectum (below), whole voxels of the box.
void cut_image(PelvisAnatomy& anatomy, const std::vector<Placed>& organs, const Vec3& spacing) {
    constexpr double shown_of_bladder = 0.6, hidden_of_rectum = 0.2;
    const auto height = [&](PelvisOrgan organ, double share) {
        double low = 1e9, high = -1e9;
        for (const Vec3& x : organs[organ].points) {
            low = std::min(low, organs[organ].shape.centre[2] + x[2]);
            high = std::max(high, organs[organ].shape.centre[2] + x[2]);
        }
        return low + share * (high - low);
    };
    const auto voxels_below = [&](double z) {
        return std::floor((z - anatomy.box_corner[2]) / spacing[2]);
    };
    const double below = voxels_below(height(rectum, hidden_of_rectum));
    const double above = voxels_below(height(bladder, shown_of_bladder));
    anatomy.image_corner[2] += below * spacing[2];
    anatomy.image_size[2] = (above - below) * spacing[2];
}

ImageGrid grid_over(const Vec3& corner, const Vec3& size, const Vec3& spacing) {
    ImageGrid grid;
    for (int axis = 0; axis < 3; ++axis) {
        grid.size[axis] = static_cast<Index>(std::lround(size[axis] / spacing[axis]));
        grid.spacing[axis] = size[axis] / double(grid.size[axis]);
    }
    grid.origin = corner + 0.5 * grid.spacing;
    return grid;
}

}  // namespace

AnatomyFamily anatomy_family_of(const std::string& name) {
    std::string known;
    for (const auto& [family, text] : anatomy_names) {
        if (name == text) return family;
        known += std::string(known.empty() ? "" : ", ") + text;
    }
    throw Error(ErrorCode::invalid_argument,
                "anatomy: '" + name + "' is not known; allowed: " + known);
}

std::string name_of(AnatomyFamily family) {
    for (const auto& [known, text] : anatomy_names)
        if (known == family) return text;
    return {};
}

AnatomyFamily drawn_for(AnatomyFamily family, unsigned seed) {
    if (family != AnatomyFamily::drawn) return family;
    constexpr int first = 1, last = int(AnatomyFamily::drawn) - 1;
    RandomNumbers random(0x73686170ull * 1000003ull + seed);
    return AnatomyFamily(first + int(random.uniform(0, last - first + 1)));
}

PelvisAnatomy make_anatomy(unsigned seed, const Vec3& spacing, AnatomyFamily family) {
    RandomNumbers random(0x70656c76ull * 1000003ull + seed);
    PelvisAnatomy anatomy;
    anatomy.organs = {make_prostate(random), make_bladder(random), make_rectum(random),
                      make_bone(random), make_bone(random)};
    shape_as(family, anatomy);
    std::vector<Placed> organs(anatomy.organs.begin(), anatomy.organs.end());
    place_organs(organs, random, family);
    fit_box(anatomy, organs, spacing);
    if (family == AnatomyFamily::cut) cut_image(anatomy, organs, spacing);
    return anatomy;
}

ImageGrid grid_of_box(const PelvisAnatomy& anatomy, const Vec3& spacing) {
    return grid_over(anatomy.box_corner, anatomy.box_size, spacing);
}

ImageGrid grid_of_image(const PelvisAnatomy& anatomy, const Vec3& spacing) {
    return grid_over(anatomy.image_corner, anatomy.image_size, spacing);
}

RegionImage fill_shapes(const PelvisAnatomy& anatomy, const ImageGrid& grid) {
    RegionImage image{grid, std::vector<std::uint8_t>(grid.num_voxels(), background_region)};
    parallel_ranges(grid.size[2], 1, [&](Index begin, Index end) {
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
