// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/tangent_response.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/estimate/column_basis.hpp"
#include "solver/base/error.hpp"
#include "solver/condense/region_mechanics.hpp"
#include "solver/model/node_rows.hpp"

namespace palpate {
namespace {

constexpr Index num_tested_walls = 4;
constexpr Eigen::Index columns_per_call = 128;  // bounds the memory: [num_dofs, 128] twice

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
    const auto quiet = [&](const Progress&) { check_cancelled(progress); };
    const auto condensed = condense_at(body.displacement, body.model, body.observed, body.driven,
                                       parts.modes, parts.spread, solver, summary, quiet);
    parts.stiffness_kpa = moduli_of(body.model);
    parts.point = point_of(body);
    parts.regions.clear();
    for (std::size_t r = 0; r < condensed.size(); ++r) {
        if (condensed[r].region != forces[r].region)
            throw Error(ErrorCode::internal, "forces of other regions than those condensed");
        parts.regions.push_back({condensed[r].region, condensed[r].stiffness, condensed[r].coupling,
                                 parts.modes.transpose() * forces[r].force});
    }
    if (unknown.size() != 1) return ResponseModel(std::move(parts));
    const std::vector<double> kpa = parts.stiffness_kpa;
    return ResponseModel::diagonal_in(unknown[0], kpa, std::move(parts));
}

class TangentBuilder {
public:
    TangentBuilder(const DeformedBody& body, const ResponseModel& rest, const WallPrior& walls,
                   const std::vector<Index>& unknown, const TangentOptions& options,
                   const ProgressSink& progress)
        : body_(body),
          walls_(walls),
          unknown_(unknown),
          options_(options),
          progress_(progress),
          moduli_(moduli_of(body.model)),
          forces_(forces_of(body)),
          tested_(walls.samples(num_tested_walls, options.seed + 1000)),
          parts_(rest.parts()) {}

    TangentResponse build();

private:
    /// On each unknown modulus.
    using Factors = Eigen::VectorXd;
    /// What the tangent at other moduli answers to the tested walls.
    struct Tested {
        Factors factors;
        Eigen::MatrixXd answers;
    };

    double factor_of(Index region, const Factors& factors) const;
    std::unique_ptr<RegionMechanics> tangent_at(const Factors& factors) const;
    Eigen::MatrixXd answers(RegionMechanics& tangent, const Loads& loads) const;
    Loads every_load() const;
    Loads tested_loads(const Factors& factors) const;
    void keep_functionals();
    std::vector<Factors> corners(double reach) const;
    std::optional<std::string> why_unstable(const Factors& factors);
    double reach_of_modes();
    double left_out_mm(const ResponseModel& model) const;
    /// Norm over all observed dofs of a root mean square over nodes.
    double tolerance() const {
        return options_.tolerance_mm * std::sqrt(std::max<double>(1, body_.observed.size()));
    }

    const DeformedBody& body_;
    const WallPrior& walls_;
    const std::vector<Index>& unknown_;
    const TangentOptions& options_;
    const ProgressSink& progress_;
    std::vector<double> moduli_;       ///< E*
    std::vector<RegionForce> forces_;  ///< g_r
    Eigen::MatrixXd tested_;           ///< motions of the walls
    std::vector<Tested> exact_;
    ResponseModel::Parts parts_;
};

double TangentBuilder::factor_of(Index region, const Factors& factors) const {
    const auto at = std::find(unknown_.begin(), unknown_.end(), region);
    return at == unknown_.end() ? 1.0 : factors[at - unknown_.begin()];
}

std::unique_ptr<RegionMechanics> TangentBuilder::tangent_at(const Factors& factors) const {
    check_cancelled(progress_);
    SolidModel model = body_.model;
    for (const Index region : unknown_)
        set_stiffness(model, region, factor_of(region, factors) * moduli_[region]);
    return make_tangent_mechanics(model, body_.displacement, options_.solver);
}

/// Displacements of the observed nodes, K x = forces with x given at the walls.
Eigen::MatrixXd TangentBuilder::answers(RegionMechanics& tangent, const Loads& loads) const {
    Eigen::MatrixXd observed(3 * body_.observed.size(), loads.walls.cols());
    for (Eigen::Index first = 0; first < observed.cols(); first += columns_per_call) {
        check_cancelled(progress_);
        const auto count = std::min<Eigen::Index>(columns_per_call, observed.cols() - first);
        Columns b = Columns::Zero(body_.model.num_dofs(), count), x;
        for (std::size_t k = 0; k < body_.driven.size(); ++k)
            b.middleRows<3>(3 * body_.driven[k]) = loads.walls.block(3 * k, first, 3, count);
        for (std::size_t k = 0; k < body_.observed.size(); ++k)
            b.middleRows<3>(3 * body_.observed[k]) = loads.forces.block(3 * k, first, 3, count);
        const LinearSolverSummary summary = tangent.solve(b, x);
        if (!summary.converged) throw Error(ErrorCode::solve_failed, summary.message);
        for (std::size_t k = 0; k < body_.observed.size(); ++k)
            observed.block(3 * k, first, 3, count) = x.middleRows<3>(3 * body_.observed[k]);
    }
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

/// With -g(E) = -sum_r E_r g_r at the observed nodes (method.md, 10.2).
Loads TangentBuilder::tested_loads(const Factors& factors) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(3 * body_.observed.size());
    for (const RegionForce& own : forces_)
        sum -= factor_of(own.region, factors) * moduli_[own.region] * own.force;
    return {sum.replicate(1, tested_.cols()), tested_};
}

/// Those first ones of `rest` without which random motions leave half the tolerance.
void TangentBuilder::keep_functionals() {
    if (parts_.functionals.rows() == parts_.functionals.cols()) return;  // nothing was left out
    // N Q^-1 N^T of the walls as they are known by now: the variance of c
    const Eigen::VectorXd variance =
        (parts_.functionals * walls_.covariance_times(parts_.functionals.transpose())).diagonal();
    const double allowed = std::pow(0.5 * tolerance(), 2);
    Eigen::Index count = parts_.influence.size();
    for (double left_out = 0; count > 1; --count) {
        left_out += std::pow(parts_.influence[count - 1], 2) * std::max(1.0, variance[count - 1]);
        if (left_out > allowed) break;
    }
    parts_.functionals = parts_.functionals.topRows(count).eval();
    parts_.spread = parts_.spread.leftCols(count).eval();
    parts_.prior_covariance = parts_.prior_covariance.topLeftCorner(count, count).eval();
    parts_.influence = parts_.influence.head(count).eval();
}

/// Soft tissue answers most: its answers come first, and most often span those of the rest.
std::vector<TangentBuilder::Factors> TangentBuilder::corners(double reach) const {
    const auto n = Eigen::Index(unknown_.size());
    if (n == 0) return {Factors()};
    std::vector<Factors> found;
    for (const double factor : {1 / reach, 1.0, reach})
        found.push_back(Factors::Constant(n, factor));
    for (Eigen::Index k = 0; n > 1 && k < n; ++k)
        for (const double factor : {1 / reach, reach}) {
            found.push_back(Factors::Ones(n));
            found.back()[k] = factor;
        }
    return found;
}

/// Modes for what the tangent at other moduli answers to the tested walls outside the span of V;
/// all that it answers if there are none yet. Returns why it cannot: that tangent is not stable.
std::optional<std::string> TangentBuilder::why_unstable(const Factors& factors) {
    try {
        const auto tangent = tangent_at(factors);
        Tested tested{factors, answers(*tangent, tested_loads(factors))};
        const Eigen::MatrixXd& modes = parts_.modes;
        const double outside =
            (tested.answers - modes * (modes.transpose() * tested.answers)).norm();
        if (modes.cols() == 0 || outside > tolerance() * std::sqrt(num_tested_walls))
            // V <- [V, what of the answers V does not span]
            parts_.modes =
                extended_basis(modes, answers(*tangent, every_load()), 0.5 * tolerance());
        exact_.push_back(std::move(tested));
        return {};
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        return error.what();
    }
}

/// The widest reach in which the tangent is stable, with modes for all of it.
double TangentBuilder::reach_of_modes() {
    std::string why;
    for (double reach = options_.reach; reach >= options_.narrowest_reach;
         reach = std::sqrt(reach)) {
        exact_.clear();
        bool is_stable = true;
        for (const Factors& factors : corners(reach)) {
            const auto found = why_unstable(factors);
            if (!found) continue;
            is_stable = false;
            why = *found;
            break;
        }
        if (is_stable) return reach;
    }
    throw Error(ErrorCode::solve_failed,
                "the deformed body is not stable for moduli near those of the search: " + why);
}

/// Of the tested walls at all moduli that were tried, root mean square over nodes.
double TangentBuilder::left_out_mm(const ResponseModel& model) const {
    double worst = 0;
    for (const Tested& tested : exact_) {
        std::vector<double> kpa = moduli_;
        for (const Index region : unknown_) kpa[region] *= factor_of(region, tested.factors);
        const auto equilibrium = model.equilibrium_at(kpa);
        double squares = 0;
        for (Eigen::Index k = 0; k < tested_.cols(); ++k)
            squares +=
                (model.observed_displacement(equilibrium, model.point().driven + tested_.col(k)) -
                 model.point().observed - tested.answers.col(k))
                    .squaredNorm();
        worst = std::max(worst, std::sqrt(squares / double(tested_.cols())));
    }
    return worst / std::sqrt(std::max<double>(1, body_.observed.size()));
}

TangentResponse TangentBuilder::build() {
    keep_functionals();
    parts_.root_tolerance = 0.5 * tolerance();
    parts_.modes.resize(parts_.modes.rows(), 0);
    const double reach = reach_of_modes();
    CondensationSummary summary;
    ResponseModel model =
        linearised(body_, forces_, parts_, unknown_, options_.solver, progress_, &summary);
    const double left_out = left_out_mm(model);
    return {std::move(model), reach, left_out, std::move(summary)};
}

}  // namespace

LinearisationPoint point_of(const DeformedBody& body) {
    return {at_nodes(body.displacement, body.driven), at_nodes(body.displacement, body.observed)};
}

TangentResponse tangent_response(const DeformedBody& body, const ResponseModel& rest,
                                 const WallPrior& walls, const std::vector<Index>& unknown,
                                 const TangentOptions& options, const ProgressSink& progress) {
    return TangentBuilder(body, rest, walls, unknown, options, progress).build();
}

ResponseModel tangent_response_near(const DeformedBody& body, const ResponseModel& earlier,
                                    const std::vector<Index>& unknown,
                                    const LinearSolverOptions& solver,
                                    const ProgressSink& progress) {
    return linearised(body, forces_of(body), earlier.parts(), unknown, solver, progress, nullptr);
}

}  // namespace palpate
