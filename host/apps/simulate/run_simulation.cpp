// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/run_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "solver/sensitivity/columns_beside.hpp"
#include "solver/sensitivity/history_columns.hpp"

namespace palpate {
namespace {

/// Time of a state of step `step` that reached the part `load` of it.
double time_of(const PreparedSimulation& prepared, std::size_t step, double load) {
    const double before = step == 0 ? 0 : prepared.time_s[step - 1];
    const double time = before + load * (prepared.time_s[step] - before);
    return prepared.is_static ? time / prepared.time_s.back() : time;
}

/// Sums; a component that is rounding beside the parts it is the sum of is 0.
std::vector<Vec3> support_forces(const PreparedSimulation& prepared,
                                 const Eigen::VectorXd& reaction) {
    constexpr double rounding = 1e-12;
    std::vector<Vec3> forces;
    for (const SupportSet& set : prepared.supports) {
        Vec3 sum = Vec3::Zero();
        double size = 0;
        for (const Index dof : set.dofs) {
            sum[dof % 3] += reaction[dof];
            size += std::abs(reaction[dof]);
        }
        for (int c = 0; c < 3; ++c)
            if (std::abs(sum[c]) <= rounding * size) sum[c] = 0;
        forces.push_back(sum);
    }
    return forces;
}

double stored_energy(const SolidAssembly& solid, const CellFields& cells,
                     const std::vector<double>& volume) {
    double energy = 0;
    for (Index e = 0; e < solid.model().mesh.num_elements(); ++e)
        energy += volume[e] * cells.energy_density_kpa[e];
    return energy;
}

std::vector<double> element_volumes(const SolidMesh& mesh) {
    const auto points = point_geometry(mesh);
    const auto per_element = static_cast<std::size_t>(mesh.table().num_points);
    std::vector<double> volume(mesh.region.size(), 0.0);
    for (std::size_t k = 0; k < points.size(); ++k) volume[k / per_element] += points[k].volume;
    return volume;
}

/// `volume` of the elements; null: cells stay empty.
SimulationState state_of(const PreparedSimulation& prepared, const SolidAssembly& solid,
                         const Equilibrium& found, double time_s,
                         const std::vector<double>* volume) {
    SimulationState state;
    state.time_s = time_s;
    state.displacement = found.displacement;
    state.reaction = found.reaction;
    if (volume) {
        state.cells = cell_fields(solid, found.displacement);
        state.energy_mn_mm = stored_energy(solid, state.cells, *volume);
    }
    state.force_mn = support_forces(prepared, found.reaction);
    state.force_mn.insert(state.force_mn.end(), found.contact.force.begin(),
                          found.contact.force.end());
    if (prepared.model.mesh.formulation == Formulation::axisymmetric)
        for (Vec3& force : state.force_mn) force.x() = 0;  // radial forces cancel
    state.depth_mm = found.contact.depth_mm;
    return state;
}

/// Where obstacles are when the part `load` of step `step` is reached.
std::vector<Vec3> motion_of(const std::vector<LoadTime>& times, std::size_t step, double load) {
    std::vector<Vec3> motion = times[step].loads.obstacle_motion;
    for (std::size_t k = 0; k < motion.size(); ++k) {
        const Vec3 before =
            step == 0 ? Vec3(Vec3::Zero()) : times[step - 1].loads.obstacle_motion[k];
        motion[k] = before + load * (motion[k] - before);
    }
    return motion;
}

SimulationState rest_state(const PreparedSimulation& prepared, const std::vector<double>* volume) {
    Equilibrium rest;
    rest.displacement.setZero(prepared.model.num_dofs());
    rest.reaction.setZero(prepared.model.num_dofs());
    rest.contact.force.assign(prepared.model.contacts.size(), Vec3::Zero());
    rest.contact.depth_mm.assign(prepared.model.contacts.size(), 0.0);
    SimulationState state = state_of(prepared, SolidAssembly(prepared.model), rest, 0, volume);
    state.obstacle_motion_mm.assign(prepared.model.contacts.size(), Vec3::Zero());
    return state;
}

/// Larger bodies share their loops among threads, and those in space are solved on devices.
constexpr Index most_dofs_beside = 8000;

/// Of the body at rest.
StateColumns columns_at_rest(const PreparedSimulation& prepared, Eigen::Index count) {
    StateColumns columns{Eigen::MatrixXd::Zero(prepared.model.num_dofs(), count), {}};
    columns.force_mn.assign(prepared.supports.size() + prepared.model.contacts.size(),
                            Eigen::Matrix3Xd::Zero(3, count));
    return columns;
}

/// Of the nodes at rest, between two models.
Eigen::VectorXd place_column(const ModelPair& pair) {
    if (!pair.models[0] || !pair.models[1]) return {};
    const auto &less = pair.models[0]->mesh.nodes, &more = pair.models[1]->mesh.nodes;
    Eigen::VectorXd column(3 * Eigen::Index(more.size()));
    for (std::size_t n = 0; n < more.size(); ++n)
        column.segment<3>(3 * Eigen::Index(n)) = (more[n] - less[n]) / pair.apart;
    return column;
}

/// Sums as those of `support_forces`.
StateColumns state_columns(const PreparedSimulation& prepared, ColumnsAtTime found) {
    StateColumns columns = columns_at_rest(prepared, found.displacement.cols());
    for (std::size_t k = 0; k < prepared.supports.size(); ++k)
        for (const Index dof : prepared.supports[k].dofs)
            columns.force_mn[k].row(dof % 3) += found.reaction.row(dof);
    std::copy(found.contact_force.begin(), found.contact_force.end(),
              columns.force_mn.begin() + std::ptrdiff_t(prepared.supports.size()));
    if (prepared.model.mesh.formulation == Formulation::axisymmetric)
        for (Eigen::Matrix3Xd& force : columns.force_mn) force.row(0).setZero();
    columns.displacement = std::move(found.displacement);
    return columns;
}

/// On the way, or on a thread beside it.
struct WishedColumns {
    std::optional<HistoryColumns> on_the_way;
    std::optional<ColumnsBeside> beside;
};

/// Those of the body at rest, and who finds the others.
WishedColumns begin_columns(SimulationResult& result, const std::vector<LoadTime>& times,
                            const SimulationWish& wish) {
    const PreparedSimulation& prepared = result.prepared;
    WishedColumns columns;
    if (!wish.directions) return columns;
    std::vector<HistoryDirection> directions = wish.directions(prepared, times);
    for (const HistoryDirection& direction : directions)
        result.place_columns.push_back(place_column(direction.pair));
    result.columns.push_back(columns_at_rest(prepared, Eigen::Index(directions.size())));
    if (wish.jobs > 1 && prepared.model.num_dofs() <= most_dofs_beside)
        columns.beside.emplace(prepared.model, times, std::move(directions),
                               result.settings.newton);
    else
        columns.on_the_way.emplace(prepared.model, times, std::move(directions));
    return columns;
}

void solve_quasi_static(SimulationResult& result, const std::vector<LoadTime>& times,
                        const SimulationWish& wish, const ProgressSink& progress) {
    const PreparedSimulation& prepared = result.prepared;
    WishedColumns columns = begin_columns(result, times, wish);
    const ProgressSink inner_progress = [&](const Progress& inner) {
        if (inner.stage.empty()) return check_cancelled(progress);
        const std::size_t step = result.steps.size();
        report_progress(progress, "solving",
                        (static_cast<double>(step) + std::max(inner.fraction, 0.0)) /
                            static_cast<double>(times.size()),
                        fmt::format("time {} of {}, {}", step + 1, times.size(), inner.message));
    };
    solve_history(
        prepared.model, times, result.settings.newton, inner_progress,
        [&](const SolidAssembly& solid, const Equilibrium& found) {
            const std::size_t step = result.steps.size();
            const double reached_s = time_of(prepared, step, found.load);
            if (found.tangent) result.tangents = found.tangent->solver();
            result.loops = solid.loops();
            result.steps.push_back({time_of(prepared, step, 1), reached_s, found.relative_residual,
                                    found.converged, found.message, found.records});
            if (found.load == 0) return;
            result.states.push_back(
                state_of(prepared, solid, found, reached_s,
                         wish.fills_cells ? &result.element_volume_mm3 : nullptr));
            result.states.back().obstacle_motion_mm = motion_of(times, step, found.load);
            if (!found.converged) return;
            if (columns.beside) columns.beside->follow(found);
            if (columns.on_the_way)
                result.columns.push_back(
                    state_columns(prepared, columns.on_the_way->advance(solid, found)));
        },
        wish.guesses);
    if (columns.beside)
        for (ColumnsAtTime& found : columns.beside->finish(progress))
            result.columns.push_back(state_columns(prepared, std::move(found)));
}

void solve_motion(SimulationResult& result, const std::vector<LoadTime>& times,
                  const ProgressSink& progress) {
    const ExplicitHistory history = solve_explicit(
        result.prepared.model, times, *result.settings.dynamics, progress,
        [&](const SolidAssembly& solid, const DynamicState& found) {
            Equilibrium moment;
            moment.displacement = found.displacement;
            moment.contact = found.contact;
            moment.reaction = found.reaction;
            result.states.push_back(
                state_of(result.prepared, solid, moment, found.time_s, &result.element_volume_mm3));
            result.states.back().kinetic_energy_mn_mm = found.kinetic_energy;
            result.states.back().obstacle_motion_mm = motion_of(times, result.steps.size(), 1);
            result.steps.push_back({found.time_s, found.time_s, 0, true, "reached", {}});
        });
    result.num_explicit_steps = history.num_steps;
    result.longest_explicit_step_s = history.longest_step_s;
    if (history.is_complete) return;
    result.steps.push_back({times[result.steps.size()].time_s,
                            result.states.back().time_s,
                            0,
                            false,
                            history.message,
                            {}});
}

}  // namespace

SimulationResult run_simulation(const SimulationSettings& settings, const ProgressSink& progress,
                                const SimulationWish& wish) {
    const auto begin = std::chrono::steady_clock::now();
    report_progress(progress, "reading", 0, "mesh and loads");
    SimulationResult result;
    result.settings = settings;
    result.prepared = prepare_simulation(settings);
    result.element_volume_mm3 = element_volumes(result.mesh());
    const PreparedSimulation& prepared = result.prepared;
    const std::size_t count = prepared.time_s.size();
    std::vector<LoadTime> times;
    for (std::size_t k = 0; k < count; ++k)
        times.push_back({prepared.time_s[k], prepared.loads_at(settings, k)});
    result.states.push_back(
        rest_state(prepared, wish.fills_cells ? &result.element_volume_mm3 : nullptr));
    if (settings.dynamics)
        solve_motion(result, times, progress);
    else
        solve_quasi_static(result, times, wish, progress);
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
}

}  // namespace palpate
