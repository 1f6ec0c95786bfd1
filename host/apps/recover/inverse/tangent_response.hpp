// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/apps/recover/inverse/response_model.hpp"
#include "host/apps/recover/inverse/wall_prior.hpp"
#include "solver/base/log.hpp"
#include "solver/condense/condensation.hpp"

namespace palpate {

/// A body in equilibrium for the moduli of its model, E*.
struct DeformedBody {
    const SolidModel& model;  ///< the displacements of driven nodes are prescribed
    const std::vector<Index>& observed;
    const std::vector<Index>& driven;
    Eigen::VectorXd displacement;  ///< u* [3 num_nodes] mm
};

struct TangentOptions {
    /// Root mean square of the observed displacement that may be left out, mm, for wall motions
    /// drawn from the prior at moduli within the reach.
    double tolerance_mm = 0.02;
    /// Factor on the unknown moduli within which the tangent is to be stable. Where it is not, the
    /// root of the factor is tried, down to `narrowest_reach`.
    double reach = 3.0, narrowest_reach = 1.2;
    unsigned seed = 1;
    LinearSolverOptions solver;
};

struct TangentResponse {
    ResponseModel model;
    double reach = 1;        ///< within which it is stable
    double left_out_mm = 0;  ///< measured for motions and moduli as `tolerance_mm` has them
    CondensationSummary condensation;
};

/// The response of a body linearised at u* (method.md, 10.2). Functionals are those of `rest`, as
/// many as the tolerance asks for. Modes span the tangent's own answers to them and to each
/// region's forces at the soft end of the reach; at E*, at the stiff end and with each of several
/// unknown moduli alone at its ends as well, where random wall motions are answered outside them.
/// Regions are condensed onto the modes alone: some hundred solves instead of one for each observed
/// degree of freedom.
///   walls    as they are known by now
///   unknown  regions whose moduli will change
/// Throws Error(solve_failed) where the tangent is not stable even within the narrowest reach.
TangentResponse tangent_response(const DeformedBody& body, const ResponseModel& rest,
                                 const WallPrior& walls, const std::vector<Index>& unknown,
                                 const TangentOptions& options, const ProgressSink& progress = {});

/// The same of a state near that of `earlier`, in its modes and functionals: one solve a mode.
/// `unknown` and throws as above, but that no reach is tried.
ResponseModel tangent_response_near(const DeformedBody& body, const ResponseModel& earlier,
                                    const std::vector<Index>& unknown,
                                    const LinearSolverOptions& solver,
                                    const ProgressSink& progress = {});

/// Where a body is: u* at its driven and its observed nodes.
LinearisationPoint point_of(const DeformedBody& body);

}  // namespace palpate
