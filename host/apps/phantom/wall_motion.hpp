// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/apps/phantom/anatomy.hpp"

namespace palpate {

/// What kind of motion the walls make.
enum class LoadFamily {
    mixed,       ///< some of all that follows
    filling,     ///< the same everywhere along the normal
    bump,        ///< a dent of some 15 mm where the wall faces the prostate
    normal,      ///< along the normal, unevenly
    tangential,  ///< along the wall
    shift,       ///< as a rigid body, but for some tenths of a millimetre
    large,       ///< mixed, 1.6 times as far
    drawn,       ///< one of these but `mixed`, at random
};
/// Throws Error(invalid_argument) naming the families.
LoadFamily load_family_of(const std::string& name);
std::string name_of(LoadFamily family);
/// Drawn for a seed, if that is what `family` says.
LoadFamily drawn_for(LoadFamily family, unsigned seed);

/// How the wall of one hollow organ moves: w = a(x) n(x) + shift + the tangential part of t(x),
/// with
///   a = (expansion (1 + c s(x)) + push max(0, n . e)^2 + bump exp(-|x - b|^2 / (2 (9 mm)^2)))
///       * (less close to other walls), mm,
/// s and t smooth random fields, n the smoothed outward normal, e the direction to the prostate and
/// b the wall's point next to its centre.
class WallMotion {
public:
    WallMotion(const PelvisAnatomy& anatomy, PelvisOrgan organ, LoadFamily family,
               RandomNumbers& random);

    /// Displacement (mm, LPS) of a point of the wall.
    Vec3 displacement(const Vec3& x) const;

    PelvisOrgan organ() const { return organ_; }
    double expansion_mm() const { return expansion_mm_; }
    double push_mm() const { return push_mm_; }
    double tangential_mm() const { return tangential_mm_; }
    const Vec3& shift_mm() const { return shift_mm_; }
    void set_shift(const Vec3& shift_mm) { shift_mm_ = shift_mm; }
    void scale_tangential(double factor) { tangential_mm_ *= factor; }

private:
    double normal_part(const Vec3& x, const Vec3& normal) const;

    const PelvisAnatomy* anatomy_;  ///< outlives this object
    PelvisOrgan organ_;
    void become(LoadFamily family);

    double expansion_mm_, push_mm_, tangential_mm_;
    double bump_mm_ = 0, unevenness_ = 0.3;
    Vec3 bump_at_ = Vec3::Zero();
    Vec3 shift_mm_;
    Vec3 to_prostate_;  ///< unit vector
    SmoothField variation_;
    std::array<SmoothField, 3> tangential_;
};

/// The motions of bladder and rectum that belong to a seed, their tangential parts multiplied by
/// `tangential_factor`.
std::vector<WallMotion> make_wall_motions(const PelvisAnatomy& anatomy, unsigned seed,
                                          double tangential_factor = 1,
                                          LoadFamily family = LoadFamily::mixed);

}  // namespace palpate
