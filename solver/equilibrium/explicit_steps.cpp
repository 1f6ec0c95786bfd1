// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/explicit_steps.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "solver/base/error.hpp"
#include "solver/equilibrium/contact_assembly.hpp"
#include "solver/equilibrium/lumped_mass.hpp"
#include "solver/equilibrium/pressure_assembly.hpp"
#include "solver/equilibrium/viscous_history.hpp"
#include "solver/model/block_product.hpp"

namespace palpate {
namespace {

void check_options(const ExplicitOptions& options) {
    if (!(options.density_kg_per_m3 > 0 && std::isfinite(options.density_kg_per_m3)))
        throw Error(ErrorCode::invalid_argument,
                    "explicit time steps need a density greater than 0 kg/m^3");
    if (!(options.damping_per_s >= 0 && std::isfinite(options.damping_per_s)) ||
        !(options.safety > 0 && options.safety < 1))
        throw Error(ErrorCode::invalid_argument,
                    "explicit time steps need a damping of 0 1/s or more and a safety factor "
                    "between 0 and 1");
}

class ExplicitSolve {
public:
    ExplicitSolve(const SolidModel& model, const std::vector<LoadTime>& times,
                  const ExplicitOptions& options, const ProgressSink& progress,
                  const MotionObserver& observer)
        : times_(times),
          options_(options),
          progress_(progress),
          observer_(observer),
          solid_(model),
          contact_(solid_.model()),
          pressure_(solid_.model()),
          history_(solid_.model()),
          matrix_(solid_.make_matrix()),
          mass_(lumped_mass(model.mesh, options.density_kg_per_m3)),
          u_(Eigen::VectorXd::Zero(model.num_dofs())),
          v_(u_),
          motion_(model.contacts.size(), Vec3::Zero()),
          friction_(contact_.num_points(), Vec3::Zero()) {}

    ExplicitHistory run();

private:
    SolidLoads loads_at(std::size_t i, double part) const;
    double stable_step();
    double contact_stiffness_per_mass() const;
    bool advance(double dt_s, const SolidLoads& loads);
    DynamicState state_at(const LoadTime& at) const;

    const std::vector<LoadTime>& times_;
    const ExplicitOptions& options_;
    const ProgressSink& progress_;
    const MotionObserver& observer_;
    SolidAssembly solid_;
    ContactAssembly contact_;
    PressureAssembly pressure_;
    ViscousHistory history_;
    BlockMatrix matrix_;
    Eigen::VectorXd mass_;
    Eigen::VectorXd u_, v_;
    InternalForce inner_;  ///< at u
    std::vector<Vec3> motion_, friction_;
};

/// A part of the way to the loads of time i.
SolidLoads ExplicitSolve::loads_at(std::size_t i, double part) const {
    SolidLoads loads = times_[i].loads;
    loads.obstacle_motion.resize(motion_.size(), Vec3::Zero());
    loads.pressure_kpa.resize(solid_.model().pressures.size(), 0.0);
    if (i == 0) {
        loads.displacement *= part;
        loads.force *= part;
        for (Vec3& by : loads.obstacle_motion) by *= part;
        for (double& kpa : loads.pressure_kpa) kpa *= part;
        return loads;
    }
    const SolidLoads& before = times_[i - 1].loads;
    // l(part) = l_i + (1 - part) (l_(i-1) - l_i)
    loads.displacement += (1 - part) * (before.displacement - loads.displacement);
    loads.force += (1 - part) * (before.force - loads.force);
    for (std::size_t c = 0; c < loads.obstacle_motion.size(); ++c) {
        const Vec3 from =
            before.obstacle_motion.empty() ? Vec3(Vec3::Zero()) : before.obstacle_motion[c];
        loads.obstacle_motion[c] += (1 - part) * (from - loads.obstacle_motion[c]);
    }
    for (std::size_t k = 0; k < loads.pressure_kpa.size(); ++k) {
        const double from = before.pressure_kpa.empty() ? 0 : before.pressure_kpa[k];
        loads.pressure_kpa[k] += (1 - part) * (from - loads.pressure_kpa[k]);
    }
    return loads;
}

double ExplicitSolve::contact_stiffness_per_mass() const {
    const Eigen::VectorXd stiffness = contact_.largest_stiffness();
    double most = 0;
    for (Index n = 0; n < stiffness.size(); ++n)
        // max k_n / m_n bounds the largest eigenvalue of the contacts' part of m^-1 K.
        if (stiffness[n] > 0) most = std::max(most, stiffness[n] / mass_[n]);
    return most;
}

double ExplicitSolve::stable_step() {
    constexpr int iterations = 60;
    constexpr double margin = 1.05;  // power iteration ends below the eigenvalue
    // Power iteration with m^-1 K: omega^2 = |m^-1 K x| of the limit, |x| = 1.
    solid_.tangent(u_, matrix_);
    pressure_.add_symmetric(u_, matrix_);
    Eigen::VectorXd x(u_.size());
    for (Eigen::Index d = 0; d < x.size(); ++d)
        x[d] = solid_.model().prescribed[d] || mass_[d / 3] == 0 ? 0 : std::cos(2.0 * d);
    double largest = 0;
    for (int k = 0; k < iterations && x.norm() > 0; ++k) {
        x.normalize();
        Eigen::VectorXd y = times(matrix_, x);
        for (Eigen::Index d = 0; d < y.size(); ++d)
            y[d] = solid_.model().prescribed[d] || mass_[d / 3] == 0 ? 0 : y[d] / mass_[d / 3];
        largest = y.norm();
        x = y;
    }
    const double square = margin * largest + contact_stiffness_per_mass();
    // dt = safety 2 / omega (method.md, 9.11)
    return square > 0 ? options_.safety * 2 / std::sqrt(square) : times_.back().time_s;
}

/// From u, v and the force at u to the next. False if matter inverts.
bool ExplicitSolve::advance(double dt_s, const SolidLoads& loads) {
    const Eigen::VectorXd before = u_;
    const double drag = 0.5 * options_.damping_per_s * dt_s;
    for (Eigen::Index d = 0; d < u_.size(); ++d) {
        if (solid_.model().prescribed[d]) {
            v_[d] = (loads.displacement[d] - u_[d]) / dt_s;
        } else if (mass_[d / 3] > 0) {
            // v' = ((1 - d) v + dt (force - f) / m) / (1 + d),  u' = u + dt v' (method.md, 9.10)
            const double push = (loads.force[d] - inner_.force[d]) / mass_[d / 3];
            v_[d] = ((1 - drag) * v_[d] + dt_s * push) / (1 + drag);
        }
        u_[d] += dt_s * v_[d];
    }
    if (has_relaxation(solid_.model())) history_.begin_step(dt_s, solid_);
    inner_ = solid_.internal_force(u_);
    if (!inner_.is_valid) return false;
    if (has_relaxation(solid_.model())) history_.end_step(dt_s, solid_, u_);
    pressure_.set(loads.pressure_kpa);
    pressure_.add_force(u_, inner_);
    if (contact_.is_empty()) return inner_.is_valid;
    // Slip counts from where this step began, with the friction then (method.md, 9.8).
    contact_.begin({before, motion_, friction_});
    contact_.place(loads.obstacle_motion);
    contact_.renew_limits(u_);
    contact_.add_force(u_, inner_);
    motion_ = loads.obstacle_motion;
    if (contact_.has_friction()) friction_ = contact_.state(u_).friction;
    return inner_.is_valid;
}

DynamicState ExplicitSolve::state_at(const LoadTime& at) const {
    DynamicState state{
        at.time_s, u_, v_, Eigen::VectorXd::Zero(u_.size()), inner_.energy, 0, contact_.state(u_)};
    for (Eigen::Index d = 0; d < v_.size(); ++d)
        if (solid_.model().prescribed[d]) state.reaction[d] = inner_.force[d] - at.loads.force[d];
    for (Eigen::Index d = 0; d < v_.size(); ++d)
        // m v^2 / 2, by component
        state.kinetic_energy += 0.5 * mass_[d / 3] * v_[d] * v_[d];
    return state;
}

ExplicitHistory ExplicitSolve::run() {
    ExplicitHistory result;
    inner_ = solid_.internal_force(u_);
    contact_.add_force(u_, inner_);
    double now_s = 0;
    for (std::size_t i = 0; i < times_.size(); ++i) {
        const double span_s = times_[i].time_s - now_s;
        const double steps = std::ceil(span_s / stable_step());
        if (result.num_steps + steps > options_.most_steps)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("explicit time steps up to {} s would be {:.2g} of {:.2g} s, "
                                    "more than {:.2g}; take solve_history, a coarser mesh or a "
                                    "higher density",
                                    times_[i].time_s, steps, span_s / steps, options_.most_steps));
        // Whole steps to each time that is asked for, none longer than the stable one.
        const double dt_s = span_s / steps;
        result.longest_step_s = std::max(result.longest_step_s, dt_s);
        for (double k = 1; k <= steps; ++k) {
            result.num_steps += 1;
            if (!advance(dt_s, loads_at(i, k / steps))) {
                result.message = fmt::format("matter inverts at {:.4g} s", now_s + k * dt_s);
                return result;
            }
            if (std::fmod(k, 256) == 0)
                report_progress(progress_, "moving", (now_s + k * dt_s) / times_.back().time_s,
                                fmt::format("{:.0f} steps", result.num_steps));
        }
        now_s = times_[i].time_s;
        result.states.push_back(state_at(times_[i]));
        if (observer_) observer_(solid_, result.states.back());
    }
    result.is_complete = true;
    result.message = "all times reached";
    return result;
}

}  // namespace

ExplicitHistory solve_explicit(const SolidModel& model, const std::vector<LoadTime>& times,
                               const ExplicitOptions& options, const ProgressSink& progress,
                               const MotionObserver& observer) {
    check_times(times);
    check_options(options);
    check_model(model);
    for (const LoadTime& at : times) check_loads(model, at.loads);
    return ExplicitSolve(model, times, options, progress, observer).run();
}

}  // namespace palpate
