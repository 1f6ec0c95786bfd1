// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// The voxels of one label volume, in the reference frame. Where a surface runs nearly along voxel
/// planes it is cut into terraces wider than the smoothing: whole patches of it are off by up to
/// half a voxel. For a plane at the angle a to voxel planes of distance h that saw tooth has
/// harmonics n = 1, 2, .. of root mean square h / (sqrt(2) pi n); a Gaussian of standard deviation
/// s leaves the fraction G_n = exp(-2 pi^2 s^2 n^2 sin^2(a) / h^2) of them, and smoothing without
/// shrinking (signed_distance.hpp) 2 G_n - G_n^2. On a phantom (true surface known, voxels of 1 x 1
/// x 3 mm, s = 1.3 mm) one surface is off by 0.43 to 0.58 mm where cos a is above 0.8, by 0.25 to
/// 0.34 mm where it is 0.6 to 0.8.
struct VoxelPlanes {
    Vec3 origin = Vec3::Zero();    ///< centre of the first voxel, mm
    Mat3 axes = Mat3::Identity();  ///< columns: directions of the grid axes
    Vec3 spacing = Vec3::Ones();   ///< mm
    double smoothing_mm = 0.9;

    /// Root mean square (mm) of the terraces along each axis of a surface with this unit normal,
    /// with the sign of the normal along that axis.
    Vec3 terrace_deviation(const Vec3& normal) const;
};

/// Families of voxel planes: three axes of two label volumes.
constexpr int max_terraces = 6;

/// The part of a distance's noise that it shares with its neighbours: for each family of voxel
/// planes a wave along their normal, standard deviation (mm) times cosine and sine of the phase.
struct Terraces {
    Eigen::Matrix<double, 2, max_terraces> waves = Eigen::Matrix<double, 2, max_terraces>::Zero();

    double variance() const { return waves.squaredNorm(); }
};

/// What terraces do to distances between two surfaces. Two places between the same planes are off
/// in the same direction, half a voxel further in the other. Where both volumes have the same
/// planes, so are a place and where it moves to: what moves by whole voxels shows no error, what
/// moves by half a voxel twice that of one surface. As far as one knows how it moves: a surface
/// along voxel planes always ends where voxels end, so that it seems to have moved by whole voxels
/// however it moved. Only the share exp(-2 pi^2 (e^2 + e'^2) / h^2) of the target's wave goes with
/// the reference's, e and e' the terraces of both; the rest is a wave of its own.
class VoxelTerraces {
public:
    VoxelTerraces() = default;
    /// `volumes`: reference and, if it is a label volume, target; or none.
    /// `range_spacings`: the correlation falls to 1/e at this many spacings.
    VoxelTerraces(std::vector<VoxelPlanes> volumes, double range_spacings);

    /// Of the distance d_target(target) - d_reference(reference); unit normals of both surfaces.
    Terraces of_distance(const Vec3& reference, const Vec3& reference_normal, const Vec3& target,
                         const Vec3& target_normal) const;
    const std::vector<VoxelPlanes>& volumes() const { return volumes_; }
    /// Where the correlation of each wave falls to 1/e, mm.
    const std::array<double, max_terraces>& range_mm() const { return range_mm_; }

private:
    std::vector<VoxelPlanes> volumes_;
    /// Family of each axis of each volume, and the direction in which its phase grows.
    std::array<std::array<int, 3>, 2> family_{};
    std::array<std::array<Vec3, 3>, 2> direction_{};
    std::array<double, max_terraces> range_mm_{};
};

}  // namespace palpate
