// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/wall_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double bump_range_mm = 9;

constexpr std::array<std::pair<LoadFamily, const char*>, 8> family_names{
    {{LoadFamily::mixed, "mixed"},
     {LoadFamily::filling, "filling"},
     {LoadFamily::bump, "bump"},
     {LoadFamily::normal, "normal"},
     {LoadFamily::tangential, "tangential"},
     {LoadFamily::shift, "shift"},
     {LoadFamily::large, "large"},
     {LoadFamily::drawn, "drawn"}}};

/// Where the ray from its centre leaves the organ.
Vec3 wall_point_towards_prostate(const OrganShape& shape, const Vec3& direction) {
    double inside = 0, outside = 1;
    while (shape.value(shape.centre + outside * direction) < 0 && outside < 200) outside *= 1.5;
    for (int halving = 0; halving < 30; ++halving) {
        const double middle = 0.5 * (inside + outside);
        (shape.value(shape.centre + middle * direction) < 0 ? inside : outside) = middle;
    }
    return shape.centre + inside * direction;
}

}  // namespace

LoadFamily load_family_of(const std::string& name) {
    std::string known;
    for (const auto& [family, text] : family_names) {
        if (name == text) return family;
        known += std::string(known.empty() ? "" : ", ") + text;
    }
    throw Error(ErrorCode::invalid_argument,
                "load: '" + name + "' is not known; allowed: " + known);
}

std::string name_of(LoadFamily family) {
    for (const auto& [known, text] : family_names)
        if (known == family) return text;
    return {};
}

LoadFamily drawn_for(LoadFamily family, unsigned seed) {
    if (family != LoadFamily::drawn) return family;
    constexpr int first = 1, last = int(LoadFamily::drawn) - 1;
    RandomNumbers random(0x6b696e64ull * 1000003ull + seed);
    return LoadFamily(first + int(random.uniform(0, last - first + 1)));
}

WallMotion::WallMotion(const PelvisAnatomy& anatomy, PelvisOrgan organ, LoadFamily family,
                       RandomNumbers& random)
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
    bump_at_ = wall_point_towards_prostate(shape, to_prostate_);
    become(family);
}

/// Lengths from those of the mixed family.
void WallMotion::become(LoadFamily family) {
    const double expansion = expansion_mm_, sign = std::copysign(1.0, expansion_mm_);
    if (family == LoadFamily::mixed) return;
    if (family == LoadFamily::large) {
        for (double* length : {&expansion_mm_, &push_mm_, &tangential_mm_}) *length *= 1.6;
        shift_mm_ *= 1.6;
        return;
    }
    expansion_mm_ = push_mm_ = 0;
    const double tangential = std::exchange(tangential_mm_, 0.0);
    const Vec3 shift = std::exchange(shift_mm_, Vec3::Zero());
    if (family == LoadFamily::filling) {
        expansion_mm_ = expansion;
        unevenness_ = 0;
    } else if (family == LoadFamily::bump) {
        bump_mm_ = 1.5 * expansion;
    } else if (family == LoadFamily::normal) {
        expansion_mm_ = expansion;
        unevenness_ = 0.6;
    } else if (family == LoadFamily::tangential) {
        tangential_mm_ = 4 * tangential;
        expansion_mm_ = 0.5 * sign;
    } else if (family == LoadFamily::shift) {
        shift_mm_ = 1.2 * shift;
        expansion_mm_ = 0.3 * sign;
        unevenness_ = 2;
    }
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
    const double off_bump = (x - bump_at_).norm() / bump_range_mm;
    return room * (expansion_mm_ * (1 + unevenness_ * variation_(x)) + push_mm_ * facing * facing +
                   bump_mm_ * std::exp(-0.5 * off_bump * off_bump));
}

Vec3 WallMotion::displacement(const Vec3& x) const {
    const Vec3 n = anatomy_->organs[organ_].smooth_normal(x);
    const Vec3 t = tangential_mm_ * Vec3(tangential_[0](x), tangential_[1](x), tangential_[2](x));
    return normal_part(x, n) * n + shift_mm_ + (t - t.dot(n) * n);
}

std::vector<WallMotion> make_wall_motions(const PelvisAnatomy& anatomy, unsigned seed,
                                          double tangential_factor, LoadFamily family) {
    RandomNumbers random(0x6c6f6164ull * 1000003ull + seed);
    std::vector<WallMotion> motions{WallMotion(anatomy, bladder, family, random),
                                    WallMotion(anatomy, rectum, family, random)};
    // What one organ does moves the whole neighbourhood: both walls share the sum of the shifts.
    const Vec3 common = motions[0].shift_mm() + motions[1].shift_mm();
    for (WallMotion& motion : motions) {
        motion.set_shift(common);
        motion.scale_tangential(tangential_factor);
    }
    return motions;
}

}  // namespace palpate
