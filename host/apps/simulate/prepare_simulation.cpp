// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "host/apps/simulate/prepare_mesh.hpp"
#include "host/apps/simulate/prepare_obstacles.hpp"
#include "host/apps/simulate/prepared_simulation.hpp"
#include "host/apps/simulate/selection.hpp"
#include "solver/base/error.hpp"
#include "solver/model/surface_load.hpp"

namespace palpate {
namespace {

/// Collects loads column by column.
class LoadParts {
public:
    LoadParts(Index num_dofs, std::size_t num_contacts, std::size_t num_pressures)
        : num_dofs_(num_dofs), num_contacts_(num_contacts), num_pressures_(num_pressures) {}

    SolidLoads& of(const std::optional<std::size_t>& column) {
        for (LoadPart& part : parts_)
            if (part.column == column) return part.full;
        SolidLoads none;
        none.displacement.setZero(num_dofs_);
        none.force.setZero(num_dofs_);
        none.obstacle_motion.assign(num_contacts_, Vec3::Zero());
        none.pressure_kpa.assign(num_pressures_, 0.0);
        parts_.push_back({column, none});
        return parts_.back().full;
    }
    std::vector<LoadPart> take() { return std::move(parts_); }

private:
    Index num_dofs_;
    std::size_t num_contacts_, num_pressures_;
    std::vector<LoadPart> parts_;
};

std::vector<std::uint8_t> nodes_of(const LoadSettings& load, const SelectableMesh& in) {
    return selected_nodes(*load.where, in);
}

/// Prescribes the components that a support names and that nobody has prescribed before.
SupportSet add_support(const SupportSettings& support, const SelectableMesh& in,
                       const std::vector<SupportSettings>& all, std::vector<int>& owner,
                       SolidModel& model, LoadParts& parts) {
    const auto is_selected = nodes_of(support, in);
    const int self = static_cast<int>(&support - all.data());
    SupportSet set{support.name, support.is_fix, {}, Vec3::Zero(), support.column, 0};
    for (int c = 0; c < 3; ++c) set.displacement_mm[c] = support.displacement_mm[c].value_or(0);
    for (std::size_t n = 0; n < is_selected.size(); ++n) {
        if (!is_selected[n]) continue;
        ++set.num_nodes;
        for (int c = 0; c < 3; ++c) {
            if (!support.displacement_mm[c]) continue;
            const std::size_t dof = 3 * n + c;
            if (owner[dof] >= 0) {
                const SupportSettings& other = all[owner[dof]];
                const bool is_same = other.column == support.column &&
                                     other.displacement_mm[c] == support.displacement_mm[c];
                if (!is_same)
                    support.source.fail(fmt::format(
                        "component {} of the node at ({:g}, {:g}, {:g}) mm is prescribed by '{}' "
                        "too; narrow one of the two with `where` or its components",
                        static_cast<char>('x' + c), in.mesh.nodes[n].x(), in.mesh.nodes[n].y(),
                        in.mesh.nodes[n].z(), other.name));
                continue;
            }
            owner[dof] = self;
            model.prescribed[dof] = 1;
            set.dofs.push_back(static_cast<Index>(dof));
            parts.of(support.column).displacement[static_cast<Eigen::Index>(dof)] =
                *support.displacement_mm[c];
        }
    }
    return set;
}

void refuse_leaving_plane(const LoadSettings& load, double z, Formulation formulation) {
    if (formulation != Formulation::solid && z != 0)
        load.source.fail("it acts along z, but a plane mesh stays in its plane; give x and y only");
}

void add_force(const ForceSettings& force, const SelectableMesh& in, LoadParts& parts) {
    refuse_leaving_plane(force, force.force_mn.z(), in.mesh.formulation);
    const auto is_selected = nodes_of(force, in);
    const auto count = std::count(is_selected.begin(), is_selected.end(), 1);
    const Vec3 each =
        force.is_total ? Vec3(force.force_mn / static_cast<double>(count)) : force.force_mn;
    for (std::size_t n = 0; n < is_selected.size(); ++n)
        if (is_selected[n])
            parts.of(force.column).force.segment<3>(3 * static_cast<Eigen::Index>(n)) += each;
}

std::size_t count_following(const std::vector<SurfaceLoadSettings>& loads) {
    return static_cast<std::size_t>(std::count_if(
        loads.begin(), loads.end(), [](const SurfaceLoadSettings& load) { return load.follows; }));
}

void add_following_pressure(const SurfaceLoadSettings& load, const SelectableMesh& in,
                            SolidModel& model, LoadParts& parts) {
    parts.of(load.column).pressure_kpa[model.pressures.size()] = load.pressure_kpa;
    model.pressures.push_back({selected_faces(*load.where, in)});
}

void add_surface_load(const SurfaceLoadSettings& load, const SelectableMesh& in, LoadParts& parts) {
    refuse_leaving_plane(load, load.traction_kpa.z(), in.mesh.formulation);
    parts.of(load.column).force += traction_forces(
        in.mesh, selected_faces(*load.where, in), [&](const Vec3&, const Vec3& normal) -> Vec3 {
            return load.traction_kpa - load.pressure_kpa * normal;
        });
}

void set_times(const SimulationSettings& settings, PreparedSimulation& prepared) {
    prepared.is_static = !settings.history.has_value();
    if (settings.history) {
        prepared.time_s = settings.history->time_s;
        return;
    }
    for (int k = 1; k <= settings.load_steps; ++k) prepared.time_s.push_back(k);
    for (SolidMaterial& material : prepared.model.materials) material.relaxation.clear();
}

}  // namespace

SolidLoads PreparedSimulation::loads_at(const SimulationSettings& settings,
                                        std::size_t step) const {
    SolidLoads loads;
    loads.displacement.setZero(model.num_dofs());
    loads.force.setZero(model.num_dofs());
    loads.obstacle_motion.assign(model.contacts.size(), Vec3::Zero());
    loads.pressure_kpa.assign(model.pressures.size(), 0.0);
    for (const LoadPart& part : parts) {
        double factor = is_static ? time_s[step] / time_s.back() : 1;
        if (part.column) factor = settings.history->factors[step][*part.column];
        loads.displacement += factor * part.full.displacement;
        loads.force += factor * part.full.force;
        for (std::size_t k = 0; k < loads.obstacle_motion.size(); ++k)
            loads.obstacle_motion[k] += factor * part.full.obstacle_motion[k];
        for (std::size_t k = 0; k < loads.pressure_kpa.size(); ++k)
            loads.pressure_kpa[k] += factor * part.full.pressure_kpa[k];
    }
    return loads;
}

PreparedSimulation prepare_simulation(const SimulationSettings& settings) {
    PreparedSimulation prepared;
    SolidModel& model = prepared.model;
    SolidMeshFile file = prepare_mesh(settings.mesh);
    prepared.labels = number_regions(settings.materials, settings.mesh, file.mesh);
    model.mesh = std::move(file.mesh);
    model.volume = settings.mesh.volume;
    for (const MaterialSettings& material : settings.materials)
        model.materials.push_back(material.material);
    model.prescribed.assign(static_cast<std::size_t>(model.num_dofs()), 0);

    prepared.point_scalars = std::move(file.point_scalars);
    const SelectableMesh in{model.mesh, prepared.point_scalars};
    LoadParts parts(model.num_dofs(), settings.obstacles.size(),
                    count_following(settings.surface_loads));
    std::vector<int> owner(model.prescribed.size(), -1);
    for (const SupportSettings& support : settings.supports) {
        refuse_leaving_plane(support, support.displacement_mm[2].value_or(0),
                             model.mesh.formulation);
        prepared.supports.push_back(
            add_support(support, in, settings.supports, owner, model, parts));
    }
    for (const ForceSettings& force : settings.forces) add_force(force, in, parts);
    for (const SurfaceLoadSettings& load : settings.surface_loads)
        if (load.follows)
            add_following_pressure(load, in, model, parts);
        else
            add_surface_load(load, in, parts);
    for (std::size_t k = 0; k < settings.obstacles.size(); ++k) {
        const ObstacleSettings& obstacle = settings.obstacles[k];
        model.contacts.push_back(contact_of(obstacle, in, model.materials));
        prepared.contact_names.push_back(obstacle.name);
        parts.of(obstacle.column).obstacle_motion[k] = obstacle.motion_mm;
    }
    prepared.parts = parts.take();
    hold_in_plane(model);
    set_times(settings, prepared);
    check_model(model);
    return prepared;
}

}  // namespace palpate
