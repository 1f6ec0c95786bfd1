// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/observations/surface_patch.hpp"
#include "host/apps/recover/observations/target_frame.hpp"
#include "host/apps/recover/observations/voxel_terraces.hpp"
#include "host/geometry/surfaces/target_shape.hpp"

namespace palpate {

/// What a surface node is compared with: the same organ in both states, both in the reference frame
/// (the target aligned), in the order of `RecoveryModel::surfaces`. An organ without a target
/// (null) carries no data.
struct ObservedShapes {
    std::vector<std::shared_ptr<const TargetShape>> reference;
    std::vector<std::shared_ptr<const TargetShape>> target;
};

/// Noise of the distance between two voxelised surfaces.
struct ObservationOptions {
    double noise_mm = 0.15;             ///< sigma_n: what is independent from point to point
    double independent_area_mm2 = 2.0;  ///< surface points closer together share that
    /// Of the reference and, if it is a label volume, the target.
    std::vector<VoxelPlanes> voxels;
    /// The correlation along terraces falls to 1/e at this distance, in spacings of their planes.
    double terrace_range_spacings = 4.0;
    /// What the target was aligned by; empty: its frame is taken to be exact.
    std::vector<AlignedPoint> aligned;
    /// Distances to what is of voxels are means over patches, with linear elements; else those of
    /// nodes, whose derivatives by the nodes' displacements are then exact.
    bool over_patches = true;
};

/// A node that may move, by its place in `RecoveryModel::driven` or `observed`; below 0: it is
/// held.
struct MovingNode {
    bool on_driven = false;
    Index position = -1;

    Vec3 displacement(const Eigen::VectorXd& driven, const Eigen::VectorXd& observed) const {
        if (position < 0) return Vec3::Zero();
        return (on_driven ? driven : observed).segment<3>(3 * position);
    }
};

struct WeightedNode {
    MovingNode node;
    double weight = 0;
};

/// The data term of one surface node: r = sum_p w_p (d_target(x_p + u_p) - d_reference(x_p)), the
/// mean distance of its patch to the target surface along its normal (method.md, 2.1). Subtracting
/// each place's own offset from the reference surface removes what chords and volume correction
/// added to the mesh.
struct Observation {
    Index surface = 0;  ///< position in `RecoveryModel::surfaces`
    Index node = 0;
    Index position = 0;  ///< in `RecoveryModel::driven` or `observed`
    bool on_driven = false;
    double independent_mm = 0;   ///< standard deviation: of a patch's mean, nodes may share voxels
    double num_measured = 1;     ///< how many measurements its mean is of
    double shared_factor = 1;    ///< on what organs share at a node of both: root of their number
    Vec3 place = Vec3::Zero();   ///< reference position of the node, mm
    Vec3 facing = Vec3::Zero();  ///< outward normal of the surface there at rest
    SurfacePatch patch;
    /// u at each place of the patch but the first: that of nodes, times weights (EdgeMiddles).
    std::vector<std::vector<WeightedNode>> patch_nodes;
};

/// Values and normals of all observations at one state.
struct ObservedState {
    /// [num_observations]; where nothing is seen: to the shape as it would go on, not to be fitted.
    Eigen::VectorXd residual_mm;
    using Vectors = Eigen::Matrix<double, Eigen::Dynamic, 3>;
    /// Gradient of the residual with respect to u, for a patch that moves as its node does.
    Vectors normal;
    Vectors smooth_normal;  ///< mean of the shape's (ShapeDistance), for linearised problems
    Vectors place;          ///< where x + u is seen, mm
    std::vector<std::uint8_t> seen;  ///< [num_observations] 0: the target says nothing there
};

class SurfaceObservations {
public:
    /// Observations of every vertex of every observed surface whose node may move. Nodes outside
    /// the box of the target's labels (in the aligned frame) carry no data: they were not seen.
    SurfaceObservations(const RecoveryModel& recovery, ObservedShapes shapes,
                        const std::vector<std::uint8_t>& node_is_seen,
                        const ObservationOptions& options);

    const std::vector<Observation>& rows() const { return rows_; }
    Index num_rows() const { return static_cast<Index>(rows_.size()); }
    /// The noise that each row shares with its neighbours, for surfaces where `state` has them.
    std::vector<Terraces> terraces(const ObservedState& state) const;
    const VoxelTerraces& voxel_terraces() const { return terraces_; }

    const FrameEvidence& frame_evidence() const { return frame_; }

    /// `driven` [3 num_driven] and `observed` [3 num_observed]: displacement in mm. `frame`: where
    /// they are seen in a target whose alignment is that far off.
    ObservedState evaluate(const Eigen::VectorXd& driven, const Eigen::VectorXd& observed,
                           const FrameMotion& frame = FrameMotion::Zero()) const;

private:
    std::vector<Observation> rows_;
    VoxelTerraces terraces_;
    FrameEvidence frame_;
    /// Mean d_target of a row's patch, each place moved by its own of `moved` (mm).
    ShapeDistance distance_of(const Observation& row, const std::vector<Vec3>& moved) const;

    std::vector<double> own_offset_;  ///< mean d_reference of each row's patch
    ObservedShapes shapes_;
};

}  // namespace palpate
