// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "host/apps/recover/inverse/nested_objective.hpp"
#include "host/apps/recover/inverse/records.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct NestedOptions {
    double relative_tolerance = 1e-4;  ///< of Phi between iterations, inner and outer
    int max_inner_iterations = 2000;   ///< per set of moduli; evaluations of Phi and its gradient
    int max_outer_iterations = 100;    ///< sets of moduli, those of the scan not counted
    double time_limit_s = 0;           ///< of the whole search, 0: none
    double smallest_kpa = 0.1, largest_kpa = 1e5;  ///< the search stays between these
    Eigen::VectorXd start;                         ///< ln E to start from; empty: scan
    std::vector<double> scan_kpa{20, 40, 80, 160, 320};
    double scan_tolerance = 1e-2;  ///< of the inner iterations of the scan
    int max_scan_iterations = 20;  ///< inner iterations per set of moduli of the scan
    std::string direct_library;    ///< as in LinearSolverOptions
};

struct NestedEstimate {
    Eigen::VectorXd displacement;  ///< [3 num_nodes] mm
    Eigen::VectorXd driven_force;  ///< [3 num_driven] mN
    std::vector<Index> unknown;    ///< regions that were estimated, ascending
    Eigen::VectorXd theta;         ///< ln E of them, E in kPa
    /// One per set of moduli of the outer search: objective Phi in mm^2, gradient norm dPhi/dln E
    /// in mm^2, step the largest movement of a node since the last record in mm.
    std::vector<IterationRecord> records;
    Termination termination;
    long solves = 0;            ///< of K x = b
    long inner_iterations = 0;  ///< evaluations of Phi and its gradient, scan included
};

/// The published way, kept as the baseline (method.md section 4): an outer L-BFGS over ln E of the
/// observed unknown regions; every evaluation of it is an inner L-BFGS over the forces on the
/// driven nodes. These start as the reactions of a Dirichlet solve that moves the nodes to their
/// closest target points, later as the best forces so far (so Phi at one E depends a little on the
/// way there). The outer gradient is the adjoint one at the end of the inner search, which holds as
/// far as dPhi/df is zero there. E starts at the best of a short list; that scan runs on the same
/// mesh with a loose inner tolerance, where the published one took a coarser mesh. There is no
/// prior and no noise model: what keeps the forces from fitting everything is that the inner search
/// stops early. Not converging is not an error: see `termination`.
NestedEstimate nested_lbfgs(const RecoveryModel& recovery, const SurfaceObservations& observations,
                            const NestedOptions& options, const ProgressSink& progress = {});

}  // namespace palpate
