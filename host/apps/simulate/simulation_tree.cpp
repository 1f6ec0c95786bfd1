// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/simulation_tree.hpp"

#include <fmt/format.h>

#include "host/apps/simulate/simulation_findings.hpp"
#include "host/page/plain_text.hpp"
#include "host/page/solver_figures.hpp"
#include "host/page/tree_values.hpp"
#include "host/system/version.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

constexpr auto json_list = ResultTree::Shape::list;

std::int64_t count_of(std::size_t count) { return static_cast<std::int64_t>(count); }

FigureValue column_name(const SimulationResult& result, const std::optional<std::size_t>& column) {
    return column ? FigureValue(result.settings.history->columns[*column]) : FigureValue();
}

ResultTree mesh_part(const SimulationResult& result) {
    const SolidMesh& mesh = result.mesh();
    return ResultTree::of(
        "mesh",
        {{"element", mesh.table().name},
         {"formulation", name_of(mesh.formulation)},
         {"thickness_mm", mesh.thickness_mm},
         {"volume",
          result.settings.mesh.volume == VolumeTreatment::pointwise ? "pointwise" : "element-mean"},
         {"nodes", mesh.num_nodes()},
         {"elements", mesh.num_elements()}});
}

ResultTree material_part(const SolidMaterial& material, Index label) {
    ResultTree part = ResultTree::of("", {{"region", label}, {"law", material.law}});
    const MaterialDescription& law = material_law(material.law);
    for (std::size_t k = 0; k < law.parameters.size(); ++k)
        part.add(std::string(law.parameters[k].name), material.parameters[k]);
    ResultTree& terms = part.add_part("relaxation", json_list);
    for (const RelaxationTerm& term : material.relaxation)
        terms.add(ResultTree::of("", {{"amplitude", term.amplitude}, {"time_s", term.time_s}}));
    if (material.relaxation.empty()) return part;
    part.add("relaxation_of", name_of(material.relaxation_of));
    part.add("instantaneous", material.is_instantaneous);
    return part;
}

ResultTree supports_part(const SimulationResult& result) {
    ResultTree list{.name = "supports", .shape = json_list};
    for (const SupportSet& set : result.prepared.supports)
        list.add(ResultTree::of(set.name, {{"name", set.name},
                                           {"kind", set.is_fix ? "fix" : "move"},
                                           {"nodes", set.num_nodes},
                                           {"degrees_of_freedom", count_of(set.dofs.size())},
                                           {"displacement_mm", components(set.displacement_mm)},
                                           {"column", column_name(result, set.column)}}));
    return list;
}

ResultTree forces_part(const SimulationResult& result) {
    ResultTree list{.name = "forces", .shape = json_list};
    for (const ForceSettings& force : result.settings.forces)
        list.add(ResultTree::of(force.name, {{"name", force.name},
                                             {"kind", force.is_total ? "total" : "nodal"},
                                             {"force_mn", components(force.force_mn)},
                                             {"column", column_name(result, force.column)}}));
    for (const SurfaceLoadSettings& load : result.settings.surface_loads)
        list.add(ResultTree::of(load.name, {{"name", load.name},
                                            {"kind", load.is_pressure ? "pressure" : "traction"},
                                            {"pressure_kpa", load.pressure_kpa},
                                            {"follows", load.follows},
                                            {"traction_kpa", components(load.traction_kpa)},
                                            {"column", column_name(result, load.column)}}));
    return list;
}

/// The radius of a tube's hole is called so; null: lengths that the shape has not.
void add_sizes(const Obstacle& obstacle, ResultTree& tree) {
    const bool is_tube = obstacle.shape == ObstacleShape::tube;
    const auto size_or_null = [](bool is_there, double size_mm) {
        return is_there ? FigureValue(size_mm) : FigureValue();
    };
    tree.add(is_tube ? "hole_radius_mm" : "radius_mm", obstacle.radius_mm);
    tree.add("edge_radius_mm", size_or_null(has_edge(obstacle.shape), obstacle.edge_radius_mm));
    tree.add("outer_radius_mm", size_or_null(is_tube, obstacle.outer_radius_mm));
    tree.add("outer_edge_radius_mm", size_or_null(is_tube, obstacle.outer_edge_radius_mm));
}

ResultTree obstacles_part(const SimulationResult& result) {
    ResultTree list{.name = "obstacles", .shape = json_list};
    for (std::size_t k = 0; k < result.settings.obstacles.size(); ++k) {
        const ObstacleSettings& settings = result.settings.obstacles[k];
        const Contact& contact = result.prepared.model.contacts[k];
        const Obstacle& obstacle = contact.obstacle;
        ResultTree part =
            ResultTree::of(settings.name, {{"name", settings.name},
                                           {"shape", name_of(obstacle.shape)},
                                           {"place_mm", components(obstacle.place)},
                                           {"direction", components(obstacle.direction)}});
        add_sizes(obstacle, part);
        part.add("hollow", obstacle.is_hollow);
        part.add("friction", contact.friction);
        part.add("stiffness_kpa_per_mm", contact.stiffness_kpa_per_mm);
        part.add("slip_stiffness_kpa_per_mm", contact.slip_stiffness_kpa_per_mm);
        part.add("motion_mm", components(settings.motion_mm));
        part.add("faces", count_of(contact.faces.size()));
        part.add("column", column_name(result, settings.column));
        list.add(std::move(part));
    }
    return list;
}

void add_history(const SimulationResult& result, ResultTree& tree) {
    if (const auto& table = result.settings.history)
        tree.add(ResultTree::of(
            "history",
            {{"columns", table->columns}, {"time_s", table->time_s}, {"factors", table->factors}}));
    else
        tree.add("history", FigureValue());
}

void add_dynamics(const SimulationResult& result, ResultTree& tree) {
    if (const auto& options = result.settings.dynamics)
        tree.add(ResultTree::of("dynamics", {{"density_kg_per_m3", options->density_kg_per_m3},
                                             {"damping_per_s", options->damping_per_s},
                                             {"safety", options->safety},
                                             {"steps", result.num_explicit_steps},
                                             {"longest_step_s", result.longest_explicit_step_s}}));
    else
        tree.add("dynamics", FigureValue());
}

ResultTree settings_part(const SimulationResult& result) {
    ResultTree tree{.name = "settings"};
    tree.add(mesh_part(result));
    ResultTree& materials = tree.add_part("materials", json_list);
    for (std::size_t k = 0; k < result.settings.materials.size(); ++k)
        materials.add(
            material_part(result.settings.materials[k].material, result.prepared.labels[k]));
    tree.add(supports_part(result));
    tree.add(forces_part(result));
    tree.add(obstacles_part(result));
    add_history(result, tree);
    add_dynamics(result, tree);
    const EquilibriumOptions& newton = result.settings.newton;
    tree.add(ResultTree::of("newton", {{"relative_tolerance", newton.relative_tolerance},
                                       {"max_steps", newton.max_newton_steps},
                                       {"first_step", newton.first_step},
                                       {"smallest_step", newton.smallest_step},
                                       {"load_steps", result.settings.load_steps}}));
    return tree;
}

ResultTree step_part(const SimulationStep& step) {
    ResultTree part = ResultTree::of("", {{"time", step.time_s},
                                          {"reached", step.reached_s},
                                          {"converged", step.converged},
                                          {"relative_residual", step.relative_residual},
                                          {"message", step.message}});
    ResultTree& records = part.add_part("newton", json_list);
    for (const NewtonRecord& record : step.records)
        records.add(ResultTree::of("", {{"load", record.load},
                                        {"relative_residual", record.relative_residual},
                                        {"step_length", record.step_length}}));
    return part;
}

ResultTree state_part(const SimulationResult& result, std::size_t k) {
    const SimulationState& state = result.states[k];
    ResultTree part =
        ResultTree::of("", {{"time", state.time_s},
                            {"file", state_file_name(k)},
                            {"largest_displacement_mm", largest_displacement(state).length_mm},
                            {"stored_energy_mn_mm", state.energy_mn_mm},
                            {"kinetic_energy_mn_mm", state.kinetic_energy_mn_mm},
                            {"volume_mm3", volume_change(result, state).after_mm3}});
    ResultTree& forces = part.add_part("force_mn");
    for (std::size_t h = 0; h < result.num_holders(); ++h)
        forces.add(result.holder_name(h), components(state.force_mn[h]));
    ResultTree& depths = part.add_part("depth_in_obstacle_mm");
    for (std::size_t c = 0; c < state.depth_mm.size(); ++c)
        depths.add(result.prepared.contact_names[c], state.depth_mm[c]);
    return part;
}

const char* kind_of(const SimulationResult& result) {
    if (result.settings.dynamics) return "motion";
    return result.prepared.is_static ? "static" : "history";
}

}  // namespace

ResultTree simulation_tree(const SimulationResult& result) {
    ResultTree tree = ResultTree::of(
        "result", {{"program", "palpate"},
                   {"version", version_text()},
                   {"title", result.settings.title},
                   {"kind", kind_of(result)},
                   {"time_means", result.prepared.is_static ? "part of the load" : "seconds"},
                   {"converged", result.converged()},
                   {"message", convergence_sentence(result)},
                   {"seconds", result.seconds}});
    add_solver("linear_solver", result.tangents, tree);
    add_loops("element_loops", result.loops, tree);
    tree.add(settings_part(result));
    ResultTree& steps = tree.add_part("steps", json_list);
    for (const SimulationStep& step : result.steps) steps.add(step_part(step));
    ResultTree& states = tree.add_part("states", json_list);
    for (std::size_t k = 0; k < result.states.size(); ++k) states.add(state_part(result, k));
    return tree;
}

std::string reactions_csv(const SimulationResult& result) {
    std::string out = result.prepared.is_static ? "load" : "time_s";
    for (std::size_t h = 0; h < result.num_holders(); ++h)
        for (const char* component : {"_x_mn", "_y_mn", "_z_mn"})
            out.append(",").append(harmless(result.holder_name(h))).append(component);
    out += "\n";
    for (const SimulationState& state : result.states) {
        out += csv_number(state.time_s);
        for (const Vec3& force : state.force_mn)
            for (int c = 0; c < 3; ++c) out.append(",").append(csv_number(force[c]));
        out += "\n";
    }
    return out;
}

std::string state_file_name(std::size_t state) { return fmt::format("state_{:04}.vtu", state); }

}  // namespace palpate
