// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/modelling/build_model.hpp"
#include "host/surfaces/distance_map.hpp"

namespace palpate {

/// What a surface node is compared with: the same organ in both states, both in the reference frame
/// (the target aligned), in the order of `RecoveryModel::surfaces`.
struct ObservedMaps {
    std::vector<DistanceMap> reference;
    std::vector<DistanceMap> target;
};

struct ObservationOptions {
    double noise_mm = 0.25;             ///< sigma_n of one independent surface point
    double correlation_area_mm2 = 7.0;  ///< area over which voxel noise is correlated
};

/// The data term of one surface node: r = d_target(x + u) - d_reference(x), the distance to the
/// target surface along its normal (method.md section 3). Subtracting the node's own offset from
/// the reference surface removes what chords and volume correction added to the mesh.
struct Observation {
    Index surface = 0;  ///< position in `RecoveryModel::surfaces`
    Index node = 0;
    Index position = 0;  ///< in `RecoveryModel::driven` or `observed`
    bool on_driven = false;
    double sigma_mm = 0;  ///< standard deviation, inflated where nodes share voxels
};

/// Values and normals of all observations at one state.
struct ObservedState {
    Eigen::VectorXd residual_mm;  ///< [num_observations]
    Eigen::Matrix<double, Eigen::Dynamic, 3>
        normal;  ///< gradient of the residual with respect to u
};

class SurfaceObservations {
public:
    /// Observations of every vertex of every observed surface whose node may move. Nodes outside
    /// `target_field`'s box (in the aligned frame) carry no data: they were not seen.
    SurfaceObservations(const RecoveryModel& recovery, ObservedMaps maps,
                        const std::vector<std::uint8_t>& node_is_seen,
                        const ObservationOptions& options);

    const std::vector<Observation>& rows() const { return rows_; }
    Index num_rows() const { return static_cast<Index>(rows_.size()); }

    /// `driven` [3 num_driven] and `observed` [3 num_observed]: displacement in mm.
    ObservedState evaluate(const Eigen::VectorXd& driven, const Eigen::VectorXd& observed) const;

private:
    std::vector<Observation> rows_;
    std::vector<Vec3> position_;      ///< reference position of each row's node
    std::vector<double> own_offset_;  ///< d_reference(x) of each row
    ObservedMaps maps_;
};

}  // namespace palpate
