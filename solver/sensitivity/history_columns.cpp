// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/sensitivity/history_columns.hpp"

#include <fmt/format.h>

#include <utility>

#include "solver/base/error.hpp"
#include "solver/equilibrium/pressure_assembly.hpp"

namespace palpate {
namespace {

void check_state(const Equilibrium& found, std::size_t next, const std::vector<double>& time_s) {
    if (next >= time_s.size())
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("the columns are at the last of {} times", time_s.size()));
    if (!found.converged)
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("there are no columns at a state that is not in equilibrium, as "
                                "the one at {} s",
                                time_s[next]));
    if (!found.tangent)
        throw Error(ErrorCode::unsupported,
                    "columns need the equilibrium with its tangent; call them from the observer of "
                    "solve_history");
}

}  // namespace

HistoryColumns::HistoryColumns(const SolidModel& model, const std::vector<LoadTime>& times,
                               std::vector<HistoryDirection> directions)
    : model_(&model), directions_(std::move(directions)), history_(model) {
    check_times(times);
    for (const LoadTime& at : times) {
        time_s_.push_back(at.time_s);
        loads_.push_back(at.loads);
    }
    for (const HistoryDirection& direction : directions_) {
        check_direction(direction, model, times.size());
        auto& pair = pairs_.emplace_back();
        for (const int side : {0, 1})
            if (const auto& other = direction.pair.models[side])
                pair[side] = std::make_unique<HeldBody>(other);
    }
    const auto columns = static_cast<Eigen::Index>(directions_.size());
    displacement_before_ = Eigen::MatrixXd::Zero(model.num_dofs(), columns);
    history_changes_.assign(directions_.size(), history_.make_tensors());
    friction_before_.resize(directions_.size());
}

SolidLoads HistoryColumns::loads_change(std::size_t column, std::size_t time) const {
    SolidLoads loads;
    loads.displacement.setZero(model_->num_dofs());
    loads.force.setZero(model_->num_dofs());
    if (!directions_[column].loads.empty()) loads = directions_[column].loads[time];
    loads.obstacle_motion.resize(model_->contacts.size(), Vec3::Zero());
    return loads;
}

RelaxationChange HistoryColumns::relaxation_change(std::size_t column) const {
    const HistoryDirection& direction = directions_[column];
    RelaxationChange change{direction.relaxation, 0};
    // d(t_i - t_(i-1)), t = 0 stays
    if (!direction.time_s.empty())
        change.dt_s = direction.time_s[next_] - (next_ == 0 ? 0 : direction.time_s[next_ - 1]);
    return change;
}

HistoryColumns::Changes HistoryColumns::solid_changes() const {
    const double dt_s = time_s_[next_] - (next_ == 0 ? 0 : time_s_[next_ - 1]);
    Changes changes;
    for (std::size_t c = 0; c < directions_.size(); ++c) {
        // df/dp at a held u: by the laws, by g + sum c_k and by Q (method.md, 9.15)
        SolidChange change = history_.begin_change(dt_s, history_changes_[c], relaxation_change(c));
        change.parameters = directions_[c].parameters;
        changes.push_back(std::move(change));
    }
    return changes;
}

/// Differences of the pairs of models at u, where they remember the same displacements: d/dp of
/// what pushes back by what differs between the models, [columns]; empty where there is no pair.
std::vector<HeldBody::Push> HistoryColumns::pair_changes(const Eigen::VectorXd& u) {
    std::vector<HeldBody::Push> changes(pairs_.size());
    for (std::size_t c = 0; c < pairs_.size(); ++c) {
        if (!pairs_[c][0] || !pairs_[c][1]) continue;
        // (f(u; p + h) - f(u; p - h)) / 2h
        const HeldBody::Push less = pairs_[c][0]->advance(time_s_[next_], u, loads_[next_]);
        changes[c] = pairs_[c][1]->advance(time_s_[next_], u, loads_[next_]);
        const double apart = directions_[c].pair.apart;
        changes[c].force = (changes[c].force - less.force) / apart;
        for (std::size_t k = 0; k < less.contact_force.size(); ++k)
            changes[c].contact_force[k] =
                (changes[c].contact_force[k] - less.contact_force[k]) / apart;
    }
    return changes;
}

HistoryColumns::ContactChanges HistoryColumns::contact_changes() const {
    ContactChanges changes;
    for (std::size_t c = 0; c < directions_.size(); ++c) {
        ContactChange change;
        change.displacement_before = displacement_before_.col(static_cast<Eigen::Index>(c));
        change.motion = loads_change(c, next_).obstacle_motion;
        change.motion_before.assign(change.motion.size(), Vec3::Zero());
        if (next_ > 0) change.motion_before = loads_change(c, next_ - 1).obstacle_motion;
        change.friction_before = friction_before_[c];
        change.coefficient = directions_[c].friction;
        change.sizes = directions_[c].sizes;
        change.penalties = directions_[c].penalties;
        changes.push_back(std::move(change));
    }
    return changes;
}

void HistoryColumns::end_step(const SolidAssembly& solid, const Equilibrium& found,
                              const Changes& changes, const ColumnsAtTime& columns) {
    const double dt_s = time_s_[next_] - (next_ == 0 ? 0 : time_s_[next_ - 1]);
    const Eigen::VectorXd& u = found.displacement;
    ViscousHistory after = history_;
    if (found.relaxing_stress.empty())
        after.end_step(dt_s, solid, u);
    else
        after.end_step(dt_s, found.relaxing_stress);
    // dS' by the displacements that follow and by the parameters, then dh_k' (method.md, 9.16)
    auto stress = solid.relaxing_stress_changes(u, columns.displacement, changes);
    for (std::size_t c = 0; c < directions_.size(); ++c)
        history_changes_[c] = history_.end_change(dt_s, history_changes_[c], after.stress(),
                                                  std::move(stress[c]), relaxation_change(c));
    history_ = std::move(after);
}

/// Of pressures that follow the surface at u, mN.
Eigen::VectorXd HistoryColumns::following_force(const Eigen::VectorXd& u,
                                                const std::vector<double>& pressure_kpa) const {
    InternalForce sum;
    sum.force.setZero(u.size());
    if (pressure_kpa.empty()) return sum.force;
    PressureAssembly pressure(*model_);
    pressure.set(pressure_kpa);
    pressure.add_force(u, sum);
    return -sum.force;
}

ColumnsAtTime HistoryColumns::advance(const SolidAssembly& solid, const Equilibrium& found) {
    check_state(found, next_, time_s_);
    const Eigen::VectorXd& u = found.displacement;
    TangentSolve& tangent = *found.tangent;
    const ContactAssembly& contact = std::as_const(tangent).contact();
    const Changes changes = solid_changes();
    const ContactChanges by_contact = contact_changes();

    const std::vector<HeldBody::Push> by_pair = pair_changes(u);

    Eigen::MatrixXd held = solid.force_changes(u, changes) + contact.force_changes(u, by_contact);
    for (std::size_t c = 0; c < by_pair.size(); ++c)
        if (by_pair[c].force.size() > 0) held.col(Eigen::Index(c)) += by_pair[c].force;
    Eigen::MatrixXd force(u.size(), held.cols());
    ColumnsAtTime columns;
    columns.displacement = Eigen::MatrixXd::Zero(u.size(), held.cols());
    for (Eigen::Index c = 0; c < held.cols(); ++c) {
        const SolidLoads loads = loads_change(static_cast<std::size_t>(c), next_);
        force.col(c) = loads.force + following_force(u, loads.pressure_kpa);
        columns.displacement.col(c) = loads.displacement;  // free dofs are overwritten
    }
    // K_ff du_f = (dforce - df)_f - K_fp du_p (method.md, 9.15)
    if (!tangent.solve_changes_at(u, force - held, columns.displacement))
        throw Error(ErrorCode::solve_failed,
                    fmt::format("the tangent at {} s is not positive definite, so columns are not "
                                "defined; the body is not stable there",
                                time_s_[next_]));
    // d reaction = K du + df - dforce at prescribed dofs
    columns.reaction = tangent.times(columns.displacement) + held - force;
    for (Eigen::Index d = 0; d < u.size(); ++d)
        if (!model_->prescribed[d]) columns.reaction.row(d).setZero();

    columns.contact_force.assign(model_->contacts.size(), Eigen::Matrix3Xd(3, held.cols()));
    auto of_contact = contact.state_changes(u, columns.displacement, by_contact);
    for (std::size_t c = 0; c < of_contact.size(); ++c) {
        for (std::size_t k = 0; k < columns.contact_force.size(); ++k)
            columns.contact_force[k].col(static_cast<Eigen::Index>(c)) =
                of_contact[c].force[k] +
                (by_pair[c].force.size() > 0 ? by_pair[c].contact_force[k] : Vec3::Zero());
        friction_before_[c] = std::move(of_contact[c].friction);
    }
    if (has_relaxation(*model_)) end_step(solid, found, changes, columns);
    displacement_before_ = columns.displacement;
    ++next_;
    return columns;
}

HistoryWithColumns solve_history_columns(const SolidModel& model,
                                         const std::vector<LoadTime>& times,
                                         std::vector<HistoryDirection> directions,
                                         const EquilibriumOptions& options,
                                         const ProgressSink& progress) {
    HistoryColumns columns(model, times, std::move(directions));
    HistoryWithColumns result;
    result.states = solve_history(model, times, options, progress,
                                  [&](const SolidAssembly& solid, const Equilibrium& found) {
                                      if (found.converged)
                                          result.columns.push_back(columns.advance(solid, found));
                                  });
    return result;
}

}  // namespace palpate
