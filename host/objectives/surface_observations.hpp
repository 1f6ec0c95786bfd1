// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "host/modelling/build_model.hpp"
#include "host/surfaces/target_shape.hpp"

namespace palpate {

/// What a surface node is compared with: the same organ in both states, both in the reference frame
/// (the target aligned), in the order of `RecoveryModel::surfaces`. An organ without a target
/// (null) carries no data.
struct ObservedShapes {
    std::vector<std::shared_ptr<const TargetShape>> reference;
    std::vector<std::shared_ptr<const TargetShape>> target;
};

/// The voxels of one label volume, in the reference frame. Where a surface runs nearly along voxel
/// planes it is cut into terraces wider than the smoothing: whole patches of it are off by up to
/// half a voxel. For a plane at the angle a to voxel planes of distance h that saw tooth has
/// harmonics n = 1, 2, .. of root mean square h / (sqrt(2) pi n); a Gaussian of standard deviation
/// s leaves the fraction G_n = exp(-2 pi^2 s^2 n^2 sin^2(a) / h^2) of them, and smoothing without
/// shrinking (signed_distance.hpp) 2 G_n - G_n^2. On phantoms (true surface known, voxels of 1 x 1
/// x 3 mm, s = 1.3 mm) one surface is off by 0.5 mm at cos a = 0.9 and by 0.3 mm at 0.7, as this
/// says with 0.15 mm of other noise.
struct VoxelPlanes {
    Mat3 axes = Mat3::Identity();  ///< columns: directions of the grid axes
    Vec3 spacing = Vec3::Ones();   ///< mm
    double smoothing_mm = 0.9;

    /// Root mean square (mm) of the terraces along each axis of a surface with this unit normal.
    Vec3 terrace_deviation(const Vec3& normal) const;
};

/// Families of voxel planes: three axes of two label volumes.
constexpr int max_terraces = 6;

/// The part of a row's noise that it shares with its neighbours: for each family of voxel planes a
/// wave along their normal, standard deviation (mm) times cosine and sine of the phase. Two places
/// between the same planes are off in the same direction, half a voxel further in the other.
struct Terraces {
    Eigen::Matrix<double, 2, max_terraces> waves = Eigen::Matrix<double, 2, max_terraces>::Zero();

    double variance() const { return waves.squaredNorm(); }
};

/// Noise of the distance between two voxelised surfaces.
struct ObservationOptions {
    double noise_mm = 0.15;             ///< sigma_n: what is independent from point to point
    double independent_area_mm2 = 2.0;  ///< surface points closer together share that
    std::vector<VoxelPlanes> voxels;    ///< of both label volumes
    /// The correlation along terraces falls to 1/e at this distance, in spacings of their planes.
    double terrace_range_spacings = 4.0;
};

/// The data term of one surface node: r = d_target(x + u) - d_reference(x), the distance to the
/// target surface along its normal (method.md section 3). Subtracting the node's own offset from
/// the reference surface removes what chords and volume correction added to the mesh.
struct Observation {
    Index surface = 0;  ///< position in `RecoveryModel::surfaces`
    Index node = 0;
    Index position = 0;  ///< in `RecoveryModel::driven` or `observed`
    bool on_driven = false;
    double independent_mm = 0;  ///< standard deviation, inflated where nodes share voxels
    Terraces terraces;
    Vec3 place = Vec3::Zero();  ///< reference position of the node, mm
};

/// Values and normals of all observations at one state.
struct ObservedState {
    /// [num_observations]; where nothing is seen: to the shape as it would go on, not to be fitted.
    Eigen::VectorXd residual_mm;
    Eigen::Matrix<double, Eigen::Dynamic, 3>
        normal;                      ///< gradient of the residual with respect to u
    std::vector<std::uint8_t> seen;  ///< [num_observations] 0: the target says nothing there
};

class SurfaceObservations {
public:
    /// Observations of every vertex of every observed surface whose node may move. Nodes outside
    /// `target_field`'s box (in the aligned frame) carry no data: they were not seen.
    SurfaceObservations(const RecoveryModel& recovery, ObservedShapes shapes,
                        const std::vector<std::uint8_t>& node_is_seen,
                        const ObservationOptions& options);

    const std::vector<Observation>& rows() const { return rows_; }
    Index num_rows() const { return static_cast<Index>(rows_.size()); }
    /// [max_terraces] where the correlation of each wave falls to 1/e, mm.
    const std::array<double, max_terraces>& terrace_range_mm() const { return terrace_range_mm_; }

    /// `driven` [3 num_driven] and `observed` [3 num_observed]: displacement in mm.
    ObservedState evaluate(const Eigen::VectorXd& driven, const Eigen::VectorXd& observed) const;

private:
    std::vector<Observation> rows_;
    std::array<double, max_terraces> terrace_range_mm_{};
    std::vector<double> own_offset_;  ///< d_reference(x) of each row
    ObservedShapes shapes_;
    std::vector<Vec3> facing_;  ///< outward normal of each row's surface at rest
};

}  // namespace palpate
