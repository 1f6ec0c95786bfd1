// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/finite_strain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/apps/recover/inverse/model_error.hpp"
#include "host/apps/recover/inverse/tangent_response.hpp"
#include "host/apps/recover/pipeline/recover_options.hpp"
#include "solver/base/error.hpp"
#include "solver/model/node_rows.hpp"

namespace palpate {
namespace {

constexpr double least_modulus_change = 1e-3;  // of ln E
/// Modes serve again where the observed nodes have moved by less (root mean square over components,
/// a thirtieth of the size of the organs), and moduli by less than this part of their reach.
constexpr double near_mm = 1.0, near_of_reach = 0.3;
/// What a response model may leave out, as a part of the least noise.
constexpr double left_out_of_noise = 0.3, most_left_out_mm = 0.1;
/// Steps of the load that are tried on the way; the end of the search goes further.
constexpr double smallest_step = 0.02;

/// Root mean square of what is independent from place to place, as it is assumed at first. What a
/// response misses is smooth: means over patches do not make it smaller.
double mean_noise_mm(const SurfaceObservations& observations) {
    double sum = 0;
    for (const auto& row : observations.rows())
        sum += row.independent_mm * row.independent_mm * row.num_measured;
    return std::sqrt(sum / std::max<Index>(1, observations.num_rows()));
}

double root_mean_square(const Eigen::VectorXd& values) {
    return values.norm() / std::sqrt(std::max<double>(1, values.size()));
}

class Rounds {
public:
    Rounds(const Mechanics& rest, const TissueLaw& law, const SurfaceObservations& observations,
           const FiniteStrainOptions& options, const ProgressSink& progress)
        : rest_(rest),
          law_(law),
          observations_(observations),
          options_(options),
          progress_(progress),
          model_(with_law(rest.recovery.model, law)),
          noise_mm_(mean_noise_mm(observations)) {}

    FiniteStrainEstimate run();

private:
    void find_equilibrium();
    Equilibrium equilibrium_from(const Eigen::VectorXd& start) const;
    void linearise();
    DeformedBody body() const;
    bool is_near_modes() const;
    bool keep_modes();
    void take_modes(double tolerance_mm);
    MapEstimate nearest_estimate();
    void search();
    void judge();
    void close(bool is_done);
    bool is_settled() const;
    void require_equilibrium() const;
    void report_round() const;
    std::vector<Index> unknown() const;

    const Mechanics& rest_;
    TissueLaw law_;
    const SurfaceObservations& observations_;
    const FiniteStrainOptions& options_;
    const ProgressSink& progress_;
    SolidModel model_;  ///< with the moduli of the estimate
    FiniteStrainEstimate found_;
    Eigen::VectorXd last_theta_;
    std::vector<IterationRecord> records_;  ///< of all searches
    LinearisationPoint modes_at_;           ///< where the last modes were found
    Eigen::VectorXd theta_of_modes_;
    double tolerance_mm_ = 0;  ///< of the last modes
    CondensationSummary condensation_;
    double reach_ = 1;  ///< of the last modes
    double noise_mm_;
    double least_noise_mm_ = 0;  ///< of the round
};

std::vector<Index> Rounds::unknown() const {
    std::vector<Index> regions;
    for (const Unknown& modulus : rest_.unknowns) regions.push_back(modulus.object);
    return regions;
}

Equilibrium Rounds::equilibrium_from(const Eigen::VectorXd& start) const {
    SolidLoads loads{Eigen::VectorXd::Zero(model_.num_dofs()),
                     Eigen::VectorXd::Zero(model_.num_dofs())};
    const auto& driven = rest_.recovery.driven;
    for (std::size_t k = 0; k < driven.size(); ++k)
        loads.displacement.segment<3>(3 * driven[k]) = found_.estimate.driven.segment<3>(3 * k);
    EquilibriumOptions solve;
    solve.linear = matrix_solver_options(options_.solver);
    solve.smallest_step = smallest_step;
    return solve_equilibrium(*found_.solid, loads, solve, {start, {}}, progress_);
}

/// At the estimate, or as near to it as one is found.
void Rounds::find_equilibrium() {
    for (std::size_t k = 0; k < rest_.unknowns.size(); ++k)
        set_stiffness(model_, rest_.unknowns[k].object,
                      std::exp(found_.estimate.theta[static_cast<Index>(k)]));
    found_.solid = std::make_shared<SolidAssembly>(
        model_, ElementLoopOptions{options_.solver.backend, options_.solver.device});
    Equilibrium state = equilibrium_from(found_.state.displacement);
    if (!state.converged && found_.state.displacement.size() > 0) state = equilibrium_from({});
    found_.state = std::move(state);
    const Eigen::VectorXd observed = at_nodes(found_.state.displacement, rest_.recovery.observed);
    found_.gap_mm = (observed - found_.estimate.observed).norm() /
                    std::sqrt(std::max<double>(1, rest_.recovery.observed.size()));
}

/// No round trusts the surfaces more than its mechanics: what these missed in the last round counts
/// as noise.
void Rounds::linearise() {
    least_noise_mm_ = noise_mm_ * std::clamp(found_.gap_mm / noise_mm_,
                                             options_.search.smallest_noise_scale, 1.0);
    const double tolerance_mm =
        std::max(options_.tangent_tolerance_mm,
                 std::min(left_out_of_noise * least_noise_mm_, most_left_out_mm));
    if (!is_near_modes() || tolerance_mm < 0.5 * tolerance_mm_ || !keep_modes())
        take_modes(tolerance_mm);
    ++found_.rounds;
}

bool Rounds::is_near_modes() const {
    if (modes_at_.observed.size() == 0) return false;
    const double moved = root_mean_square(point_of(body()).observed - modes_at_.observed);
    const double changed = (found_.estimate.theta - theta_of_modes_).lpNorm<Eigen::Infinity>();
    return moved < near_mm && changed < near_of_reach * std::log(reach_);
}

/// The tangent in the modes that there are; false where it is not stable within their reach.
bool Rounds::keep_modes() {
    try {
        auto next = std::make_shared<ResponseModel>(
            tangent_response_near(body(), *found_.response, unknown(), options_.solver, progress_));
        for (const double factor : {1 / reach_, reach_}) {
            std::vector<double> kpa = moduli_of(model_);
            for (const Index region : unknown()) kpa[region] *= factor;
            if (!next->is_stable(kpa)) return false;
        }
        found_.response = std::move(next);
        return true;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        return false;
    }
}

DeformedBody Rounds::body() const {
    return {model_, rest_.recovery.observed, rest_.recovery.driven, found_.state.displacement};
}

void Rounds::take_modes(double tolerance_mm) {
    TangentOptions tangent;
    tangent.tolerance_mm = tolerance_mm_ = tolerance_mm;
    tangent.solver = options_.solver;
    const WallPrior& walls = found_.estimate.walls ? *found_.estimate.walls : rest_.walls;
    TangentResponse taken =
        tangent_response(body(), rest_.response, walls, unknown(), tangent, progress_);
    found_.response = std::make_shared<ResponseModel>(std::move(taken.model));
    reach_ = taken.reach;
    condensation_ = std::move(taken.condensation);
    modes_at_ = point_of(body());
    theta_of_modes_ = found_.estimate.theta;
}

/// Of several moduli the reach holds for all together and for each alone. Where the search comes to
/// others that are not stable, it stays nearer.
MapEstimate Rounds::nearest_estimate() {
    MapOptions search = options_.search;
    search.smallest_noise_scale = least_noise_mm_ / noise_mm_;
    for (;; reach_ = std::sqrt(reach_)) {
        search.reach = reach_;
        try {
            return map_estimate_near(found_.estimate, *found_.response, rest_.walls, observations_,
                                     rest_.unknowns, search, progress_);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::solve_failed || rest_.unknowns.size() < 2 ||
                reach_ < TangentOptions{}.narrowest_reach)
                throw;
        }
    }
}

void Rounds::search() {
    last_theta_ = found_.estimate.theta;
    found_.estimate = nearest_estimate();
    append_records(records_, found_.estimate.records);
}

bool Rounds::is_settled() const {
    if (!found_.state.converged || found_.gap_mm > options_.displacement_tolerance_mm) return false;
    for (Index k = 0; k < last_theta_.size(); ++k) {
        const double sd =
            std::hypot(std::sqrt(found_.estimate.covariance(k, k)), options_.model_sd_ln);
        const double allowed = std::max(least_modulus_change, options_.modulus_tolerance_sd * sd);
        if (std::abs(found_.estimate.theta[k] - last_theta_[k]) > allowed) return false;
    }
    return true;
}

/// What is said of moduli far from the estimated ones. There the tangent says nothing: linear
/// elasticity does, shifted such that it agrees at the estimate.
void Rounds::judge() {
    MapEstimate& estimate = found_.estimate;
    const auto kpa = rest_.response.moduli(unknown(), estimate.theta);
    const WallPrior& walls = estimate.walls ? *estimate.walls : rest_.walls;
    const ResponseModel shifted =
        rest_.response
            .shifted_by(estimate.observed -
                        rest_.response.observed_displacement(kpa, estimate.driven))
            .with_walls(walls);
    FramePrior frame = estimate.counted->frame();
    frame.motion = estimate.frame;
    const LinearisedProblem problem(shifted, walls,
                                    estimate.counted->linear_rows(observations_.evaluate(
                                        estimate.driven, estimate.observed, estimate.frame)),
                                    estimate.driven, estimate.observed, rest_.unknowns, frame);
    MapEstimate far = estimate;
    take_uncertainty(problem, options_.search, far, progress_);
    estimate.excluded_ends = far.excluded_ends;
    for (Index k = 0; k < estimate.theta.size(); ++k) {
        if (profile_half_width(estimate.covariance, k) <= std::log(reach_)) continue;
        far.posterior = estimate.posterior;
        estimate = std::move(far);
        return;
    }
}

void Rounds::close(bool is_done) {
    Termination& termination = found_.estimate.termination;
    found_.estimate.records = std::move(records_);
    termination.iterations = static_cast<int>(found_.estimate.records.size());
    termination.reason =
        is_done
            ? fmt::format("{} rounds of linearisation, then {}", found_.rounds, termination.reason)
            : fmt::format(
                  "{} rounds of linearisation were not enough: the last one still "
                  "moved the observed surfaces by {:.2g} mm (--max-rounds allows more)",
                  found_.rounds, found_.gap_mm);
    termination.converged = is_done && termination.converged;
    found_.solver = condensation_.solver;
    found_.solver.reason = "Newton's method at large deformation";
    found_.loops = found_.solid->loops();
}

void Rounds::require_equilibrium() const {
    if (found_.state.converged) return;
    throw Error(ErrorCode::solve_failed,
                fmt::format("the {} body has no equilibrium with the walls where the search puts "
                            "them ({}); try --material linear, or another number of --nodes",
                            law_.name, found_.state.message));
}

FiniteStrainEstimate Rounds::run() {
    MapOptions first = options_.search;
    first.smallest_noise_scale = std::max(1.0, first.smallest_noise_scale);
    found_.estimate =
        map_estimate(rest_.response, rest_.walls, observations_, rest_.unknowns, first, progress_);
    found_.first = found_.estimate;
    found_.first.posterior.reset();
    append_records(records_, found_.estimate.records);
    bool is_done = false;
    for (find_equilibrium(); !is_done && found_.rounds < options_.max_rounds;
         is_done = is_settled()) {
        linearise();
        search();
        find_equilibrium();
        report_round();
    }
    require_equilibrium();
    judge();
    close(is_done);
    return std::move(found_);
}

void Rounds::report_round() const {
    std::string text;
    for (const double theta : found_.estimate.theta)
        text += fmt::format(" {:.4g} kPa,", std::exp(theta));
    report_progress(
        progress_, "searching", -1,
        fmt::format("round {}:{} {:.2g} mm from equilibrium", found_.rounds, text, found_.gap_mm));
}

[[noreturn]] void refuse(const std::string& option, const TissueLaw& law, const std::string& why) {
    throw Error(ErrorCode::invalid_argument,
                option + " does not go with --material " + law.name + ": " + why);
}

}  // namespace

FiniteStrainEstimate search_finite_strain(const Mechanics& rest, const TissueLaw& law,
                                          const SurfaceObservations& observations,
                                          const FiniteStrainOptions& options,
                                          const ProgressSink& progress) {
    return Rounds(rest, law, observations, options, progress).run();
}

void check_tissue_law(const RecoverOptions& options) {
    if (options.law.is_linear()) return;
    if (options.method == SearchMethod::nested_lbfgs)
        refuse("--method nested-lbfgs", options.law,
               "the published method is linear here; use --method map");
    if (options.settings.has_unknown_poisson_ratio())
        refuse("poisson_ratio = \"unknown\"", options.law,
               "its search condenses tissue at rest; give the ratios as numbers");
}

}  // namespace palpate
