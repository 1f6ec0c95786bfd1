// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/simulate/cell_fields.hpp"
#include "host/apps/simulate/prepared_simulation.hpp"
#include "solver/sensitivity/history_directions.hpp"

namespace palpate {

/// The body at one time.
struct SimulationState {
    double time_s = 0;             ///< of a static load the part of it, 0 to 1
    Eigen::VectorXd displacement;  ///< [3 num_nodes] mm
    Eigen::VectorXd reaction;      ///< [3 num_nodes] mN
    CellFields cells;
    double energy_mn_mm = 0;               ///< stored by the laws alone
    double kinetic_energy_mn_mm = 0;       ///< of a motion
    std::vector<Vec3> force_mn;            ///< [holders] resultants on the body
    std::vector<Vec3> obstacle_motion_mm;  ///< [obstacles] from where the model has them
    std::vector<double> depth_mm;          ///< [obstacles] how deep the body is in them
};

/// How a state changes with each of some parameters, per unit of them.
struct StateColumns {
    Eigen::MatrixXd displacement;            ///< [3 num_nodes, columns] mm
    std::vector<Eigen::Matrix3Xd> force_mn;  ///< [holders][3, columns] as `SimulationState`
};

/// The directions along which states are differentiated.
using SimulationDirections = std::function<std::vector<HistoryDirection>(
    const PreparedSimulation& prepared, const std::vector<LoadTime>& times)>;

/// What a run is asked for beside its states.
struct SimulationWish {
    SimulationDirections directions = {};  ///< the states come with their columns
    /// [times] displacements that are near (`solve_history`), may be empty.
    std::vector<Eigen::VectorXd> guesses = {};
    bool fills_cells = true;  ///< whether states have `cells` and energies
    int jobs = 1;             ///< threads: with two the columns of small bodies come beside
};

/// How one step was solved.
struct SimulationStep {
    double time_s = 0;  ///< that was asked for
    double reached_s = 0;
    double relative_residual = 0;
    bool converged = false;
    std::string message;
    std::vector<NewtonRecord> records;
};

struct SimulationResult {
    SimulationSettings settings;
    PreparedSimulation prepared;
    std::vector<double> element_volume_mm3;
    std::vector<SimulationState> states;  ///< the first is the body at rest
    std::vector<SimulationStep> steps;    ///< the last may not have converged
    std::vector<StateColumns> columns;    ///< [states] if directions were given, else empty
    /// [directions] how nodes at rest change, [3 num_nodes] mm per unit; empty: they do not.
    std::vector<Eigen::VectorXd> place_columns;
    double num_explicit_steps = 0, longest_explicit_step_s = 0;  ///< of a motion
    /// Who solved with the last tangent, and who had the element loops; none of a motion.
    std::optional<LinearSolverInfo> tangents;
    std::optional<ElementLoopInfo> loops;
    double seconds = 0;  ///< of the solve

    bool converged() const { return steps.back().converged; }
    /// What exerts forces on the body: first the supports, then the obstacles.
    std::size_t num_holders() const {
        return prepared.supports.size() + prepared.contact_names.size();
    }
    const std::string& holder_name(std::size_t holder) const {
        const std::size_t supports = prepared.supports.size();
        return holder < supports ? prepared.supports[holder].name
                                 : prepared.contact_names[holder - supports];
    }
    const SolidMesh& mesh() const { return prepared.model.mesh; }
};

/// Solves for all times, as a motion if the settings ask for it. Not converging is reported in the
/// last step; the last state is what was reached. With `wish.directions`, which a motion does not
/// take, the states come with their columns, up to the last that converged. Throws Error as
/// `prepare_simulation`, `solve_history` and `HistoryColumns` do.
SimulationResult run_simulation(const SimulationSettings& settings,
                                const ProgressSink& progress = {}, const SimulationWish& wish = {});

}  // namespace palpate
