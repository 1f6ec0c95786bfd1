// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

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
/// half a voxel. For a plane at the angle a to voxel planes of distance h, smoothed by a Gaussian
/// of standard deviation s, the first harmonic of that saw tooth is left, with a root mean square
/// of
///   h / (sqrt(2) pi) exp(-2 pi^2 s^2 sin^2(a) / h^2).
/// On phantoms (true motion known, 1 mm voxels, s = 0.9 mm) the error of one surface is 0.2 mm
/// below 10 degrees and 0.11 mm elsewhere, as this says.
struct VoxelPlanes {
    Mat3 axes = Mat3::Identity();  ///< columns: directions of the grid axes
    Vec3 spacing = Vec3::Ones();   ///< mm
    double smoothing_mm = 0.9;

    /// Variance (mm^2) of the terraces of a surface with this unit normal.
    double terrace_variance(const Vec3& normal) const;
};

/// Noise of the distance between two voxelised surfaces.
struct ObservationOptions {
    double noise_mm = 0.15;             ///< sigma_n: what is independent from point to point
    double independent_area_mm2 = 2.0;  ///< surface points closer together share that
    std::vector<VoxelPlanes> voxels;    ///< of both label volumes
    double terrace_range_mm = 4.0;      ///< the correlation along terraces falls to 1/e
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
    double correlated_mm = 0;   ///< standard deviation of the terraces, which neighbours share
    Vec3 place = Vec3::Zero();  ///< reference position of the node, mm
};

/// Values and normals of all observations at one state.
struct ObservedState {
    Eigen::VectorXd residual_mm;  ///< [num_observations]
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
    double correlation_range_mm() const { return correlation_range_mm_; }

    /// `driven` [3 num_driven] and `observed` [3 num_observed]: displacement in mm.
    ObservedState evaluate(const Eigen::VectorXd& driven, const Eigen::VectorXd& observed) const;

private:
    std::vector<Observation> rows_;
    double correlation_range_mm_;
    std::vector<double> own_offset_;  ///< d_reference(x) of each row
    ObservedShapes shapes_;
    std::vector<Vec3> facing_;  ///< outward normal of each row's surface at rest
};

}  // namespace palpate
