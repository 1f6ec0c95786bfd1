// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "solver/equilibrium/viscous_history.hpp"
#include "solver/sensitivity/held_body.hpp"
#include "solver/sensitivity/history_directions.hpp"

namespace palpate {

/// How the state of a body at one time changes with each of some parameters, per unit of them.
struct ColumnsAtTime {
    Eigen::MatrixXd displacement;  ///< [3 num_nodes, columns] mm, prescribed dofs included
    /// [3 num_nodes, columns] mN: of the forces that hold prescribed dofs, zero elsewhere.
    Eigen::MatrixXd reaction;
    std::vector<Eigen::Matrix3Xd> contact_force;  ///< [contacts][3, columns] mN, on the body
};

/// Forward derivatives through `solve_history`, exact for its time steps: at each time
///   K du/dp = dforce/dp - df/dp,   f at a held u,
/// with df/dp by the parameter itself, by what relaxation and friction remember, and by where the
/// step began; then the changes of what is remembered are handed on (method.md, 9.15 and 9.16;
/// Michaleris, Tortorelli and Vidal 1994, section 3.1). One solve a time and column with the last
/// factor of the step, side by side. For few parameters and many observations; for one scalar and
/// many parameters there is `history_gradient`.
/// Friction's derivatives are those of the side on which each contact point is, slipping or not.
/// Penalties of obstacles stay, but where a direction says how they follow.
class HistoryColumns {
public:
    /// At rest, before the first time.
    ///   model, times   as given to `solve_history`; `model` must outlive this object
    /// Throws Error(invalid_argument) as `check_times` and `check_direction` do.
    HistoryColumns(const SolidModel& model, const std::vector<LoadTime>& times,
                   std::vector<HistoryDirection> directions);

    /// The columns at the next time, whose equilibrium is `found` on `solid`: to be called from a
    /// `TimeObserver`, once for each time, before the tangent is gone. Of both only the tangent of
    /// `found` is used up: the history that is solved stays the same, within Newton's tolerance
    /// where later times begin with that. Throws Error(invalid_argument) for a state that did not
    /// converge and beyond the last time, Error(unsupported) for one without tangent,
    /// Error(solve_failed) if that is not positive definite.
    ColumnsAtTime advance(const SolidAssembly& solid, const Equilibrium& found);

    /// The directions that were given: one column each.
    const std::vector<HistoryDirection>& directions() const { return directions_; }

private:
    using Changes = std::vector<SolidChange>;
    using ContactChanges = std::vector<ContactChange>;

    RelaxationChange relaxation_change(std::size_t column) const;
    Changes solid_changes() const;
    ContactChanges contact_changes() const;
    SolidLoads loads_change(std::size_t column, std::size_t time) const;
    Eigen::VectorXd following_force(const Eigen::VectorXd& u,
                                    const std::vector<double>& pressure_kpa) const;
    std::vector<HeldBody::Push> pair_changes(const Eigen::VectorXd& u);
    void end_step(const SolidAssembly& solid, const Equilibrium& found, const Changes& changes,
                  const ColumnsAtTime& columns);

    const SolidModel* model_;
    std::vector<double> time_s_;
    std::vector<SolidLoads> loads_;  ///< [times]
    std::vector<HistoryDirection> directions_;
    std::size_t next_ = 0;
    ViscousHistory history_;
    std::vector<std::array<std::unique_ptr<HeldBody>, 2>> pairs_;  ///< [columns] null: none
    std::vector<HistoryTensors> history_changes_;                  ///< [columns]
    Eigen::MatrixXd displacement_before_;                          ///< [3 num_nodes, columns]
    std::vector<std::vector<Vec3>> friction_before_;               ///< [columns][contact points]
};

/// A load history with its columns.
struct HistoryWithColumns {
    std::vector<Equilibrium> states;     ///< as `solve_history` returns them
    std::vector<ColumnsAtTime> columns;  ///< at all times that converged
};

/// `solve_history`, and the columns on the way. Throws as that and `HistoryColumns` do.
HistoryWithColumns solve_history_columns(const SolidModel& model,
                                         const std::vector<LoadTime>& times,
                                         std::vector<HistoryDirection> directions,
                                         const EquilibriumOptions& options = {},
                                         const ProgressSink& progress = {});

}  // namespace palpate
