// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/newton.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// A step may raise the energy by rounding, as a part of the work that it stands for.
constexpr double rounding = 1e-10;
/// A body that does not touch yet has a tangent without the obstacle: its first step goes k d / p
/// too far, d what it would move by, p the pressure that stops it: some 1e3 to 1e4, at any load.
constexpr double shortest_length = 1.0 / 65536;
constexpr double largest_shift = 20;
constexpr int most_friction_rounds = 200;
/// Newton steps from a guess; the path from the start is sure, and no longer than that.
constexpr int most_guess_steps = 10;
constexpr double near_enough = 1e-2;  // relative residual from which old factors are tried

void check_options(const EquilibriumOptions& options) {
    const bool has_steps = options.smallest_step > 0 &&
                           options.smallest_step <= options.first_step && options.first_step <= 1;
    if (has_steps && options.relative_tolerance > 0 && options.max_newton_steps > 0) return;
    throw Error(ErrorCode::invalid_argument,
                "load steps need 0 < smallest <= first <= 1, a tolerance above 0 and at least one "
                "Newton step");
}

class EquilibriumSolve {
public:
    EquilibriumSolve(const SolidAssembly& solid, const SolidLoads& loads,
                     const EquilibriumOptions& options, const EquilibriumStart& start,
                     const ProgressSink& progress)
        : solid_(solid),
          loads_(loads),
          options_(options),
          start_(start),
          progress_(progress),
          tangent_(start.tangent ? start.tangent
                                 : std::make_shared<TangentSolve>(solid, options.linear)) {}

    Equilibrium run();

private:
    /// A displacement and what it stores under a part of the load.
    struct State {
        Eigen::VectorXd u;
        InternalForce inner;
        double total_energy = 0;   ///< stored less the work of the forces
        Eigen::VectorXd residual;  ///< force - f at free dofs, zero elsewhere
    };

    ContactAssembly& contact() const { return tangent_->contact(); }
    void set_surroundings(double load) const;
    double path_work(const State& from, const State& to) const {
        return tangent_->pressure().work(from.u, to.u);
    }
    State state_at(const Eigen::VectorXd& u, double load) const;
    /// At a part of the way from the start to the full load.
    double force_at(Eigen::Index dof, double load) const {
        return start_.force[dof] + load * (loads_.force[dof] - start_.force[dof]);
    }
    double displacement_at(Eigen::Index dof, double load) const {
        return start_.displacement[dof] +
               load * (loads_.displacement[dof] - start_.displacement[dof]);
    }
    double relative_residual(const State& state, double load) const;
    bool find_change(const State& state, const Eigen::VectorXd& r, Eigen::VectorXd& change);
    bool reach(double load, State& state);
    bool reach_from_guess(State& state);
    bool settle(double load, State& state) {
        return settle(load, state, options_.max_newton_steps);
    }
    bool settle(double load, State& state, int most_steps);
    bool settle_friction(double load, State& state);
    bool take_friction_step(double load, State& state);
    bool advance_walls(double load, State& state);
    bool take_chord_step(double load, State& state);
    double search_line(double load, const Eigen::VectorXd& change, State& state) const;

    const SolidAssembly& solid_;
    const SolidLoads& loads_;
    const EquilibriumOptions& options_;
    EquilibriumStart start_;
    const ProgressSink& progress_;
    std::shared_ptr<TangentSolve> tangent_;
    bool is_shifted_ = false;    ///< the last tangent
    bool is_unchecked_ = false;  ///< no tangent was made since the load went on
    std::string failure_;        ///< why the last load step failed
    std::vector<NewtonRecord> records_;
};

/// Obstacles and following pressures, on their way from the start to the full load.
void EquilibriumSolve::set_surroundings(double load) const {
    std::vector<Vec3> motion = start_.obstacle_motion;
    for (std::size_t c = 0; c < motion.size(); ++c)
        // a + load (b - a): linear from the start of the path to its end
        motion[c] += load * (loads_.obstacle_motion[c] - motion[c]);
    contact().place(motion);
    std::vector<double> pressure = start_.pressure_kpa;
    for (std::size_t k = 0; k < pressure.size(); ++k)
        pressure[k] += load * (loads_.pressure_kpa[k] - pressure[k]);
    tangent_->pressure().set(pressure);
}

EquilibriumSolve::State EquilibriumSolve::state_at(const Eigen::VectorXd& u, double load) const {
    State state{u, solid_.internal_force(u), 0, Eigen::VectorXd::Zero(u.size())};
    contact().add_force(u, state.inner);
    tangent_->pressure().add_force(u, state.inner);
    // Pi = W + contact energy - force . u,  residual = -dPi/du = force - f(u) (method.md, 9.5)
    state.total_energy = state.inner.energy;
    if (!state.inner.is_valid) return state;
    for (Eigen::Index d = 0; d < u.size(); ++d) {
        if (tangent_->free().number[d] < 0) continue;
        state.residual[d] = force_at(d, load) - state.inner.force[d];
        state.total_energy -= force_at(d, load) * u[d];
    }
    // What overflows is no state to go on from, as little as one in which matter is inverted.
    if (!std::isfinite(state.total_energy) || !state.residual.allFinite())
        state.inner.is_valid = false;
    return state;
}

double EquilibriumSolve::relative_residual(const State& state, double load) const {
    // |force - f| over the largest of |f|, |contact forces|, |following pressures| and |force|;
    // zero where it is no more than what rounding of u makes of forces.
    if (state.residual.norm() <= tangent_->force_of_rounding(state.u)) return 0;
    double applied = 0;
    for (Eigen::Index d = 0; d < state.u.size(); ++d)
        if (tangent_->free().number[d] >= 0) applied += std::pow(force_at(d, load), 2);
    return state.residual.norm() / std::max({state.inner.force.norm(), state.inner.contact_force,
                                             state.inner.pressure_force, std::sqrt(applied)});
}

/// The change that the tangent at a state makes of r and of what it holds at prescribed dofs; the
/// tangent is shifted where it is not positive definite: then still a way down.
bool EquilibriumSolve::find_change(const State& state, const Eigen::VectorXd& r,
                                   Eigen::VectorXd& change) {
    is_shifted_ = is_unchecked_ = false;
    // K + shift mean(diag K): 0, 1e-3, 4e-3, .. until it is positive definite; then K^-1 r is a
    // direction in which Pi goes down.
    for (double shift = 0; shift < largest_shift; shift = is_shifted_ ? 4 * shift : 1e-3) {
        is_shifted_ = shift > 0;
        if (tangent_->factorise(state.u, shift) && tangent_->solve(r, change)) return true;
        if (!tangent_->is_indefinite()) break;
    }
    failure_ = tangent_->failure();
    return false;
}

/// Moves the prescribed dofs to their places under `load` and the others as the tangent says. False
/// if that inverts matter.
bool EquilibriumSolve::advance_walls(double load, State& state) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(state.u.size());
    for (Eigen::Index d = 0; d < change.size(); ++d)
        // K_ff du_f = -K_fp du_p: the rest follows the prescribed as the tangent says.
        if (solid_.model().prescribed[d]) change[d] = displacement_at(d, load) - state.u[d];
    // Where none moves there is nothing to find; what the tangent knows of stability is still owed.
    is_unchecked_ = change.isZero(0);
    if (!is_unchecked_ && !find_change(state, Eigen::VectorXd::Zero(change.size()), change))
        return false;
    State next = state_at(state.u + change, load);
    if (!next.inner.is_valid) {
        failure_ = "matter inverts";
        return false;
    }
    state = std::move(next);
    return true;
}

/// The longest of 1, 1/2, 1/4, .. at which nothing inverts and the total energy has not grown; 0 if
/// there is none.
double EquilibriumSolve::search_line(double load, const Eigen::VectorXd& change,
                                     State& state) const {
    // dPi/du . du
    const double slope = -state.residual.dot(change);
    for (double length = 1; length >= shortest_length; length *= 0.5) {
        State next = state_at(state.u + length * change, load);
        if (!next.inner.is_valid) continue;
        // Pi(u + a du) <= Pi(u) + 1e-4 a dPi/du . du + rounding (Armijo; method.md, 9.5), or a
        // residual of half the size: near an equilibrium differences of Pi are rounding. Following
        // pressures take off the work that they do on the way (method.md, 9.19).
        const double allowed = rounding * (std::abs(slope) + std::abs(state.total_energy));
        const bool has_small_residual = next.residual.norm() <= 0.5 * state.residual.norm();
        if (next.total_energy - path_work(state, next) >
                state.total_energy + 1e-4 * length * slope + allowed &&
            !has_small_residual)
            continue;
        state = std::move(next);
        return length;
    }
    return 0;
}

/// Near the end the last factor does as well as a new one, and costs little: a step with it is
/// taken if it leaves a tenth of the residual.
bool EquilibriumSolve::take_chord_step(double load, State& state) {
    if (is_shifted_ || !tangent_->is_factorised()) return false;
    Eigen::VectorXd change = Eigen::VectorXd::Zero(state.u.size());
    // K_old du = residual, with the factor that is there: |residual'| <= |residual| / 10, or none
    if (!tangent_->solve(state.residual, change)) return false;
    State next = state_at(state.u + change, load);
    if (!next.inner.is_valid || next.residual.norm() > 0.1 * state.residual.norm()) return false;
    records_.back().step_length = 1;
    state = std::move(next);
    return true;
}

bool EquilibriumSolve::reach(double load, State& state) {
    set_surroundings(load);
    if (!advance_walls(load, state) || !settle(load, state)) return false;
    return !contact().has_friction() || settle_friction(load, state);
}

/// A Newton step with the tangent that knows that limits follow pressures, from a state whose do;
/// it is taken if it leaves half of the residual.
bool EquilibriumSolve::take_friction_step(double load, State& state) {
    constexpr double tolerance = 1e-3;  // the next step sees to the rest
    Eigen::MatrixXd change;
    // (K + dt/dlimit dlimit/du) du = residual, not symmetric where friction slips
    if (!tangent_->solve_columns_at(state.u, state.residual, change, false, tolerance))
        return false;
    is_shifted_ = false;
    const Eigen::VectorXd u = state.u + change.col(0);
    contact().renew_limits(u);
    State next = state_at(u, load);
    if (!next.inner.is_valid || next.residual.norm() > 0.5 * state.residual.norm()) {
        contact().renew_limits(state.u);
        return false;
    }
    records_.push_back({load, relative_residual(state, load), 1});
    state = std::move(next);
    return true;
}

/// Renews the limits of friction until they agree with the pressures that they lead to.
bool EquilibriumSolve::settle_friction(double load, State& state) {
    for (int round = 0; round < most_friction_rounds; ++round) {
        contact().renew_limits(state.u);
        state = state_at(state.u, load);
        if (relative_residual(state, load) <= options_.relative_tolerance) return true;
        // limit = mu p(u) (method.md, 9.8) with this u, until f with the new limits still balances.
        if (take_friction_step(load, state)) continue;
        if (!settle(load, state)) return false;
    }
    failure_ = "friction and pressure do not agree";
    return false;
}

bool EquilibriumSolve::settle(double load, State& state, int most_steps) {
    for (int step = 0;; ++step) {
        const double residual = relative_residual(state, load);
        records_.push_back({load, residual, 0});
        report_progress(progress_, "equilibrium", load,
                        fmt::format("step {}, residual {:.1e}", records_.size(), residual));
        // Done. But a shifted K has hidden negative curvature: an equilibrium is stable only if K
        // itself is positive definite there.
        if (residual <= options_.relative_tolerance) {
            failure_ = "the equilibrium is not stable";
            return !(is_shifted_ || is_unchecked_) || tangent_->factorise(state.u);
        }
        if (residual < near_enough && take_chord_step(load, state)) continue;
        failure_ = fmt::format("{} Newton steps were not enough", most_steps);
        if (step >= most_steps) return false;
        Eigen::VectorXd change = Eigen::VectorXd::Zero(state.u.size());
        if (!find_change(state, state.residual, change)) return false;
        // K du = residual (method.md, 9.4), then u + a du
        records_.back().step_length = search_line(load, change, state);
        failure_ = "no step lowers the energy without inverting matter";
        if (records_.back().step_length == 0) return false;
    }
}

/// The equilibrium at full load from the guess; false, with `state` as it was, if that fails.
bool EquilibriumSolve::reach_from_guess(State& state) {
    Eigen::VectorXd u = start_.guess;
    for (Eigen::Index d = 0; d < u.size(); ++d)
        if (solid_.model().prescribed[d]) u[d] = displacement_at(d, 1);
    set_surroundings(1);
    contact().renew_limits(u);
    State next = state_at(u, 1);
    if (next.inner.is_valid &&
        settle(1, next, std::min(most_guess_steps, options_.max_newton_steps)) &&
        (!contact().has_friction() || settle_friction(1, next))) {
        state = std::move(next);
        return true;
    }
    contact().begin({start_.displacement, start_.obstacle_motion, start_.friction});
    return false;
}

Equilibrium EquilibriumSolve::run() {
    Equilibrium result;
    contact().begin({start_.displacement, start_.obstacle_motion, start_.friction});
    set_surroundings(0);
    State reached = state_at(start_.displacement, 0);
    double step = options_.first_step;
    if (start_.guess.size() > 0 && reach_from_guess(reached)) result.load = 1;
    while (result.load < 1 && step >= options_.smallest_step) {
        const double load = std::min(1.0, result.load + step);
        State next = reached;
        // A step that arrives is followed by one 1.5 times as long, one that does not is halved.
        if (reach(load, next)) {
            reached = std::move(next);
            step = 1.5 * (load - result.load);
            result.load = load;
        } else {
            step = 0.5 * (load - result.load);
        }
    }
    result.converged = result.load >= 1;
    result.message = result.converged
                         ? "in equilibrium"
                         : fmt::format("no equilibrium beyond {:.3g} % of the load: {}",
                                       100 * result.load, failure_);
    result.relative_residual = relative_residual(reached, result.load);
    result.displacement = reached.u;
    set_surroundings(result.load);
    result.contact = contact().state(reached.u);
    result.energy = reached.inner.energy;
    result.reaction = Eigen::VectorXd::Zero(reached.u.size());
    for (Eigen::Index d = 0; d < reached.u.size(); ++d)
        if (solid_.model().prescribed[d])
            // reaction = f(u) - force: what holds a prescribed dof
            result.reaction[d] = reached.inner.force[d] - force_at(d, result.load);
    result.records = std::move(records_);
    result.tangent = std::move(tangent_);
    return result;
}

}  // namespace

void check_loads(const SolidModel& model, const SolidLoads& loads) {
    const Index dofs = model.num_dofs();
    if (loads.displacement.size() != dofs || loads.force.size() != dofs)
        throw Error(ErrorCode::invalid_argument,
                    "displacements and forces need 3 numbers per node: " + std::to_string(dofs));
    const std::size_t contacts = model.contacts.size();
    if (!loads.obstacle_motion.empty() && loads.obstacle_motion.size() != contacts)
        throw Error(ErrorCode::invalid_argument,
                    "obstacles move by one vector each: " + std::to_string(contacts) + ", not " +
                        std::to_string(loads.obstacle_motion.size()));
    for (const Vec3& by : loads.obstacle_motion)
        if (!by.allFinite())
            throw Error(ErrorCode::invalid_argument,
                        "the motion of an obstacle is not a finite number");
    check_pressures(model, loads.pressure_kpa);
    if (!loads.displacement.allFinite() || !loads.force.allFinite())
        throw Error(ErrorCode::invalid_argument,
                    "a prescribed displacement or force is not a finite number");
}

Equilibrium solve_equilibrium(const SolidAssembly& solid, const SolidLoads& loads,
                              const EquilibriumOptions& options, const EquilibriumStart& start,
                              const ProgressSink& progress) {
    check_loads(solid.model(), loads);
    check_options(options);
    const auto fits = [&](const Eigen::VectorXd& given) {
        return given.size() == 0 || (given.size() == loads.force.size() && given.allFinite());
    };
    if (!fits(start.displacement) || !fits(start.force) || !fits(start.guess))
        throw Error(ErrorCode::invalid_argument,
                    "the start of a load path needs 3 finite numbers per node, or none");
    if (!start.obstacle_motion.empty() &&
        start.obstacle_motion.size() != solid.model().contacts.size())
        throw Error(ErrorCode::invalid_argument,
                    "the start of a load path needs the motion of every obstacle, or none");
    check_pressures(solid.model(), start.pressure_kpa);
    EquilibriumStart from = start;
    if (from.displacement.size() == 0) from.displacement.setZero(loads.displacement.size());
    if (from.force.size() == 0) from.force.setZero(loads.force.size());
    SolidLoads to = loads;
    from.obstacle_motion.resize(solid.model().contacts.size(), Vec3::Zero());
    to.obstacle_motion.resize(solid.model().contacts.size(), Vec3::Zero());
    from.pressure_kpa.resize(solid.model().pressures.size(), 0.0);
    to.pressure_kpa.resize(solid.model().pressures.size(), 0.0);
    return EquilibriumSolve(solid, to, options, from, progress).run();
}

}  // namespace palpate
