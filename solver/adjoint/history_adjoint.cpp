// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/history_adjoint.hpp"

#include <fmt/core.h>

#include "solver/base/error.hpp"
#include "solver/equilibrium/viscous_history.hpp"

namespace palpate {
namespace {

void check(const SolidModel& model, const std::vector<LoadTime>& times,
           const std::vector<Equilibrium>& states, const std::vector<Eigen::VectorXd>& dj_du) {
    check_times(times);
    if (states.size() != times.size() || dj_du.size() != times.size())
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("a gradient through {} times needs as many states and slopes; "
                                "there are {} and {}",
                                times.size(), states.size(), dj_du.size()));
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (!states[i].converged)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("there is no gradient through a state that is not in "
                                    "equilibrium, as the one at {} s",
                                    times[i].time_s));
        if (states[i].displacement.size() != model.num_dofs() ||
            (dj_du[i].size() > 0 && dj_du[i].size() != model.num_dofs()))
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("a displacement and the slope of an objective need 3 numbers "
                                    "per node: {}",
                                    model.num_dofs()));
    }
}

/// Goes through a history again, remembering, and back.
class HistoryAdjoint {
public:
    HistoryAdjoint(const SolidModel& model, const std::vector<LoadTime>& times,
                   const std::vector<Equilibrium>& states, const std::string& direct_library);

    HistoryGradient run(const std::vector<Eigen::VectorXd>& dj_du, const ProgressSink& progress);

private:
    double dt_s(std::size_t i) const {
        return times_[i].time_s - (i == 0 ? 0 : times_[i - 1].time_s);
    }
    void remember();
    void enter_step(std::size_t i);
    void step_back(std::size_t i, const Eigen::VectorXd& dj_du, HistoryGradient& gradient);

    const std::vector<LoadTime>& times_;
    const std::vector<Equilibrium>& states_;
    SolidAssembly solid_;
    TangentSolve tangent_;
    std::vector<ViscousHistory> histories_;  ///< where each step began

    // Slopes of J by what the step under way leaves to the next one.
    Eigen::VectorXd by_displacement_;
    std::vector<Vec3> by_motion_, by_friction_;
    HistoryTensors by_history_;
};

HistoryAdjoint::HistoryAdjoint(const SolidModel& model, const std::vector<LoadTime>& times,
                               const std::vector<Equilibrium>& states,
                               const std::string& direct_library)
    : times_(times),
      states_(states),
      solid_(model),
      tangent_(solid_, {.direct_library = direct_library}) {
    remember();
    by_displacement_ = Eigen::VectorXd::Zero(model.num_dofs());
    by_motion_.assign(model.contacts.size(), Vec3::Zero());
    by_friction_.assign(states.empty() ? 0 : states[0].contact.friction.size(), Vec3::Zero());
    by_history_ = histories_.front().make_tensors();
}

void HistoryAdjoint::remember() {
    ViscousHistory history(solid_.model());
    for (std::size_t i = 0; i < times_.size(); ++i) {
        histories_.push_back(history);
        // S_n and h_k of every step's beginning, from the displacements that were found (method.md,
        // 9.6)
        history.begin_step(dt_s(i), solid_);
        history.end_step(dt_s(i), solid_, states_[i].displacement);
    }
    histories_.push_back(history);
}

/// As when `solve_history` ended the step.
void HistoryAdjoint::enter_step(std::size_t i) {
    histories_[i].begin_step(dt_s(i), solid_);
    ContactAssembly& contact = tangent_.contact();
    if (i == 0) contact.begin({});
    if (i > 0)
        contact.begin({states_[i - 1].displacement, times_[i - 1].loads.obstacle_motion,
                       states_[i - 1].contact.friction});
    contact.place(times_[i].loads.obstacle_motion);
    contact.renew_limits(states_[i].displacement);
    tangent_.pressure().set(times_[i].loads.pressure_kpa);
}

void HistoryAdjoint::step_back(std::size_t i, const Eigen::VectorXd& dj_du,
                               HistoryGradient& gradient) {
    enter_step(i);
    const Eigen::VectorXd& u = states_[i].displacement;
    const ContactAssembly& contact = tangent_.contact();
    // Everything that u_i does to J: by itself, by the stress and the friction that it leaves to
    // the
    // next step, and by being where that step began. K^T lambda = total (method.md, 9.13).
    const auto stress_slope = histories_[i].stress_slope(dt_s(i), by_history_);
    Eigen::VectorXd total = by_displacement_ + solid_.relaxing_stress_gradient(u, stress_slope) +
                            contact.friction_gradient(u, by_friction_);
    if (dj_du.size() > 0) total += dj_du;
    Eigen::VectorXd lambda;
    if (!tangent_.solve_at(u, total, lambda))
        throw Error(ErrorCode::solve_failed,
                    fmt::format("the tangent at {} s is not positive definite, so its gradient is "
                                "not defined; the body is not stable there",
                                times_[i].time_s));

    // dJ/dforce = lambda; dJ/du_p = (total - K^T lambda)_p at prescribed dofs (method.md, 9.12)
    gradient.force[i] = lambda;
    gradient.pressure_kpa[i] = tangent_.pressure().products(u, lambda);
    gradient.displacement[i] = total - tangent_.times(lambda);
    for (Eigen::Index d = 0; d < u.size(); ++d)
        if (!solid_.model().prescribed[d]) gradient.displacement[i][d] = 0;

    // -lambda . df_i by motions, friction and displacement at the step's beginning: handed back
    const ContactGradient by_contact = contact.start_gradient(u, lambda, by_friction_);
    for (std::size_t c = 0; c < by_motion_.size(); ++c)
        gradient.obstacle_motion[i].push_back(by_motion_[c] + by_contact.motion[c]);
    by_displacement_ = by_contact.displacement_before;
    by_motion_ = by_contact.motion_before;
    by_friction_ = by_contact.friction_before;

    const ViscousSlopes by_step = solid_.viscous_slopes(u, lambda, stress_slope);
    for (std::size_t m = 0; m < by_step.parameters.size(); ++m)
        for (std::size_t k = 0; k < by_step.parameters[m].size(); ++k)
            // dJ/dp = sum over steps of -lambda_i . df_i/dp (method.md, 9.14)
            gradient.parameters[m][k] += by_step.parameters[m][k];
    // The slopes by h_k and S_n for the step before, and those by C_k and tau_k (method.md, 9.6).
    by_history_ = histories_[i].slopes_before(dt_s(i), by_history_, by_step,
                                              histories_[i + 1].stress(), gradient.relaxation);
}

HistoryGradient HistoryAdjoint::run(const std::vector<Eigen::VectorXd>& dj_du,
                                    const ProgressSink& progress) {
    HistoryGradient gradient;
    for (const SolidMaterial& material : solid_.model().materials) {
        gradient.parameters.emplace_back(material.parameters.size(), 0.0);
        gradient.relaxation.emplace_back(material.relaxation.size(), RelaxationTerm{0, 0});
    }
    gradient.force.resize(times_.size());
    gradient.displacement.resize(times_.size());
    gradient.obstacle_motion.resize(times_.size());
    gradient.pressure_kpa.resize(times_.size());
    for (std::size_t i = times_.size(); i-- > 0;) {
        step_back(i, dj_du[i], gradient);
        report_progress(progress, "gradient", 1 - static_cast<double>(i) / times_.size(),
                        fmt::format("back at {:.3g} s", times_[i].time_s));
    }
    return gradient;
}

}  // namespace

HistoryGradient history_gradient(const SolidModel& model, const std::vector<LoadTime>& times,
                                 const std::vector<Equilibrium>& states,
                                 const std::vector<Eigen::VectorXd>& dj_du,
                                 const std::string& direct_library, const ProgressSink& progress) {
    check(model, times, states, dj_du);
    return HistoryAdjoint(model, times, states, direct_library).run(dj_du, progress);
}

}  // namespace palpate
