// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/tangent_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/estimate/column_basis.hpp"
#include "solver/base/error.hpp"
#include "solver/condense/region_mechanics.hpp"
#include "solver/model/node_rows.hpp"

namespace palpate {
namespace {

constexpr Index num_tested_walls = 4;

/// Forces at the observed nodes [3 |observed|, n] mN and motions of the walls [3 |driven|, n] mm.
struct Loads {
    Eigen::MatrixXd forces, walls;
};

std::vector<RegionForce> forces_of(const DeformedBody& body) {
    return region_forces(body.displacement, body.model, body.observed, body.driven);
}

/// The tangent at u* in the modes and functionals of `parts`.
ResponseModel linearised(const DeformedBody& body, const std::vector<RegionForce>& forces,
                         ResponseModel::Parts parts, const std::vector<Index>& unknown,
                         const LinearSolverOptions& solver, const ProgressSink& progress,
                         CondensationSummary* summary) {
    const auto condensed = condense_at(body.displacement, body.model, body.observed, body.driven,
                                       parts.modes, parts.spread, solver, summary, progress);
    parts.stiffness_kpa = moduli_of(body.model);
    parts.point = point_of(body);
    parts.regions.clear();
    for (std::size_t r = 0; r < condensed.size(); ++r)
        parts.regions.push_back({condensed[r].region, condensed[r].stiffness, condensed[r].coupling,
                                 parts.modes.transpose() * forces[r].force});
    if (unknown.size() != 1) return ResponseModel(std::move(parts));
    const std::vector<double> kpa = parts.stiffness_kpa;
    return ResponseModel::diagonal_in(unknown[0], kpa, std::move(parts));
}

class TangentBuilder {
public:
    TangentBuilder(const DeformedBody& body, const ResponseModel& rest, const WallPrior& prior,
                   const std::vector<Index>& unknown, const TangentOptions& options,
                   const ProgressSink& progress)
        : body_(body),
          prior_(prior),
          unknown_(unknown),
          options_(options),
          progress_(progress),
          moduli_(moduli_of(body.model)),
          forces_(forces_of(body)),
          parts_(rest.parts()) {}

    TangentResponse build();

private:
    SolidModel model_at(double factor) const;
    std::unique_ptr<RegionMechanics> tangent_at(double factor) const;
    Eigen::MatrixXd answers(RegionMechanics& tangent, const Loads& loads) const;
    Loads every_load() const;
    Eigen::VectorXd imbalance_at(double factor) const;
    void keep_functionals();
    void take_modes(const Eigen::MatrixXd& answers);
    bool extend_to(double factor, const Eigen::MatrixXd& walls);
    double reach_of_modes();
    /// Norm over all observed dofs of a root mean square over nodes.
    double tolerance() const {
        return options_.tolerance_mm * std::sqrt(std::max<double>(1, body_.observed.size()));
    }

    const DeformedBody& body_;
    const WallPrior& prior_;
    const std::vector<Index>& unknown_;
    const TangentOptions& options_;
    const ProgressSink& progress_;
    std::vector<double> moduli_;       ///< E*
    std::vector<RegionForce> forces_;  ///< g_r
    ResponseModel::Parts parts_;
};

/// The unknown moduli times `factor`.
SolidModel TangentBuilder::model_at(double factor) const {
    SolidModel model = body_.model;
    for (const Index region : unknown_) set_stiffness(model, region, factor * moduli_[region]);
    return model;
}

std::unique_ptr<RegionMechanics> TangentBuilder::tangent_at(double factor) const {
    check_cancelled(progress_);
    return make_tangent_mechanics(model_at(factor), body_.displacement, options_.solver);
}

/// Displacements of the observed nodes, K x = forces with x given at the walls.
Eigen::MatrixXd TangentBuilder::answers(RegionMechanics& tangent, const Loads& loads) const {
    check_cancelled(progress_);
    Columns b = Columns::Zero(body_.model.num_dofs(), loads.walls.cols()), x;
    for (std::size_t k = 0; k < body_.driven.size(); ++k)
        b.middleRows<3>(3 * body_.driven[k]) = loads.walls.middleRows<3>(3 * k);
    for (std::size_t k = 0; k < body_.observed.size(); ++k)
        b.middleRows<3>(3 * body_.observed[k]) = loads.forces.middleRows<3>(3 * k);
    const LinearSolverSummary summary = tangent.solve(b, x);
    if (!summary.converged)
        throw Error(ErrorCode::solve_failed,
                    "the tangent of the body could not be solved: " + summary.message);
    Eigen::MatrixXd observed(3 * body_.observed.size(), x.cols());
    for (std::size_t k = 0; k < body_.observed.size(); ++k)
        observed.middleRows<3>(3 * k) = x.middleRows<3>(3 * body_.observed[k]);
    return observed;
}

/// Unit motions of all functionals, Q^-1 N^T, and the forces of each region at E*.
Loads TangentBuilder::every_load() const {
    const auto functionals = parts_.spread.cols(), regions = Eigen::Index(forces_.size());
    Loads loads{Eigen::MatrixXd::Zero(3 * body_.observed.size(), functionals + regions),
                Eigen::MatrixXd::Zero(3 * body_.driven.size(), functionals + regions)};
    loads.walls.leftCols(functionals) = parts_.spread;
    for (Eigen::Index r = 0; r < regions; ++r)
        loads.forces.col(functionals + r) = moduli_[forces_[r].region] * forces_[r].force;
    return loads;
}

/// -g(E) = -sum_r E_r g_r with the unknown moduli times `factor` (method.md, 10.2).
Eigen::VectorXd TangentBuilder::imbalance_at(double factor) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(3 * body_.observed.size());
    for (const RegionForce& own : forces_) {
        const bool is_unknown =
            std::find(unknown_.begin(), unknown_.end(), own.region) != unknown_.end();
        sum -= (is_unknown ? factor : 1) * moduli_[own.region] * own.force;
    }
    return sum;
}

/// Those first ones of `rest` without which random motions leave half the tolerance.
void TangentBuilder::keep_functionals() {
    const double allowed = std::pow(0.5 * tolerance(), 2);
    Eigen::Index count = parts_.influence.size();
    // c ~ N(0, 1): what functionals from `count` on move has the variance of their influences
    for (double left_out = 0; count > 1; --count) {
        left_out += std::pow(parts_.influence[count - 1], 2);
        if (left_out > allowed) break;
    }
    parts_.functionals = parts_.functionals.topRows(count).eval();
    parts_.spread = parts_.spread.leftCols(count).eval();
    parts_.prior_covariance = parts_.prior_covariance.topLeftCorner(count, count).eval();
    parts_.influence = parts_.influence.head(count).eval();
    parts_.root_tolerance = 0.5 * tolerance();
}

/// V <- [V, what of the answers V does not span]
void TangentBuilder::take_modes(const Eigen::MatrixXd& answers) {
    parts_.modes = extended_basis(parts_.modes, answers, 0.5 * tolerance());
}

/// Modes for what the tangent at other moduli answers to `walls` outside the span of V; all that it
/// answers if there are none yet. Returns whether that tangent is stable.
bool TangentBuilder::extend_to(double factor, const Eigen::MatrixXd& walls) {
    std::unique_ptr<RegionMechanics> tangent;
    try {
        tangent = tangent_at(factor);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        return false;
    }
    bool is_spanned = parts_.modes.cols() > 0;
    if (is_spanned) {
        const Loads loads{imbalance_at(factor).replicate(1, walls.cols()), walls};
        const Eigen::MatrixXd exact = answers(*tangent, loads);
        const Eigen::MatrixXd outside = exact - parts_.modes * (parts_.modes.transpose() * exact);
        is_spanned = outside.norm() <= tolerance() * std::sqrt(walls.cols());
    }
    if (!is_spanned) take_modes(answers(*tangent, every_load()));
    return true;
}

/// The widest reach in which the tangent is stable, with modes for all of it. Soft tissue answers
/// most: its answers come first, and most often span those of the rest.
double TangentBuilder::reach_of_modes() {
    const Eigen::MatrixXd walls = prior_.samples(num_tested_walls, options_.seed + 1000);
    for (double reach = options_.reach;; reach = std::sqrt(reach)) {
        if (extend_to(1 / reach, walls) && extend_to(1, walls) && extend_to(reach, walls))
            return reach;
        if (reach < options_.narrowest_reach)
            throw_indefinite("tangent of the deformed body", body_.model.num_dofs());
    }
}

TangentResponse TangentBuilder::build() {
    keep_functionals();
    parts_.modes.resize(parts_.modes.rows(), 0);
    const double reach = reach_of_modes();
    CondensationSummary summary;
    ResponseModel model = linearised(body_, forces_, std::move(parts_), unknown_, options_.solver,
                                     progress_, &summary);
    return {std::move(model), reach, std::move(summary)};
}

}  // namespace

LinearisationPoint point_of(const DeformedBody& body) {
    return {at_nodes(body.displacement, body.driven), at_nodes(body.displacement, body.observed)};
}

TangentResponse tangent_response(const DeformedBody& body, const ResponseModel& rest,
                                 const WallPrior& prior, const std::vector<Index>& unknown,
                                 const TangentOptions& options, const ProgressSink& progress) {
    return TangentBuilder(body, rest, prior, unknown, options, progress).build();
}

ResponseModel tangent_response_near(const DeformedBody& body, const ResponseModel& earlier,
                                    const std::vector<Index>& unknown,
                                    const LinearSolverOptions& solver,
                                    const ProgressSink& progress) {
    return linearised(body, forces_of(body), earlier.parts(), unknown, solver, progress, nullptr);
}

}  // namespace palpate
