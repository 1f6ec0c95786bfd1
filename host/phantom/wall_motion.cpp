// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/phantom/wall_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate {

WallMotion::WallMotion(const PelvisAnatomy& anatomy, PelvisOrgan organ, RandomNumbers& random)
    : anatomy_(&anatomy), organ_(organ) {
    // More often the organ fills; an organ that empties pulls the prostate along instead.
    const double sign = random.is_below(0.65) ? 1.0 : -1.0;
    const OrganShape& shape = anatomy.organs[organ];
    to_prostate_ = (anatomy.organs[prostate].centre - shape.centre).normalized();
    const double amount = sign > 0 ? 1.0 : 0.7;  // a wall that shrinks folds sooner than it tears
    expansion_mm_ = sign * amount * random.uniform(3, 5);
    push_mm_ = sign * amount * random.uniform(1, 2.5);
    tangential_mm_ = random.uniform(0.4, 1.0);
    const Vec3 across = to_prostate_.cross(Vec3::UnitX()).normalized();
    const double towards_mm = sign * random.uniform(2, 4.5);
    const double sideways_mm = random.uniform(-1.5, 1.5), across_mm = random.uniform(-1, 1);
    shift_mm_ = towards_mm * to_prostate_ + sideways_mm * Vec3::UnitX() + across_mm * across;
    variation_ = SmoothField(random, 35, 70);
    for (SmoothField& field : tangential_) field = SmoothField(random, 40, 80);
}

double WallMotion::normal_part(const Vec3& x, const Vec3& normal) const {
    constexpr double range_mm = 10;  // closer to a wall that does not give way, the motion is less
    const double facing = std::max(0.0, normal.dot(to_prostate_));
    double room = 1;
    for (Index other = 0; other < num_pelvis_organs; ++other) {
        if (other == organ_ || other == prostate) continue;
        const double distance = std::max(0.0, anatomy_->organs[other].value(x));
        room *= 1 - 0.8 * std::exp(-std::pow(distance / range_mm, 2));
    }
    return room * (expansion_mm_ * (1 + 0.3 * variation_(x)) + push_mm_ * facing * facing);
}

Vec3 WallMotion::displacement(const Vec3& x) const {
    const Vec3 n = anatomy_->organs[organ_].smooth_normal(x);
    const Vec3 t = tangential_mm_ * Vec3(tangential_[0](x), tangential_[1](x), tangential_[2](x));
    return normal_part(x, n) * n + shift_mm_ + (t - t.dot(n) * n);
}

std::vector<WallMotion> make_wall_motions(const PelvisAnatomy& anatomy, unsigned seed,
                                          double tangential_factor) {
    RandomNumbers random(0x6c6f6164ull * 1000003ull + seed);
    std::vector<WallMotion> motions{WallMotion(anatomy, bladder, random),
                                    WallMotion(anatomy, rectum, random)};
    // What one organ does moves the whole neighbourhood: both walls share the sum of the shifts.
    const Vec3 common = motions[0].shift_mm() + motions[1].shift_mm();
    for (WallMotion& motion : motions) {
        motion.set_shift(common);
        motion.scale_tangential(tangential_factor);
    }
    return motions;
}

}  // namespace palpate
