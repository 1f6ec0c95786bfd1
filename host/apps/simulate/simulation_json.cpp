// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/simulation_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/apps/simulate/simulation_findings.hpp"
#include "host/page/plain_text.hpp"
#include "host/system/version.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json vector3(const Vec3& v) { return Json{number(v.x()), number(v.y()), number(v.z())}; }

Json column_json(const SimulationResult& result, const std::optional<std::size_t>& column) {
    return column ? Json(result.settings.history->columns[*column]) : Json(nullptr);
}

Json mesh_json(const SimulationResult& result) {
    const SolidMesh& mesh = result.mesh();
    return {{"element", mesh.table().name},
            {"formulation", name_of(mesh.formulation)},
            {"thickness_mm", mesh.thickness_mm},
            {"volume", result.settings.mesh.volume == VolumeTreatment::pointwise ? "pointwise"
                                                                                 : "element-mean"},
            {"nodes", mesh.num_nodes()},
            {"elements", mesh.num_elements()}};
}

Json material_json(const SolidMaterial& material, Index label) {
    Json json{{"region", label}, {"law", material.law}};
    const MaterialDescription& law = material_law(material.law);
    for (std::size_t k = 0; k < law.parameters.size(); ++k)
        json[std::string(law.parameters[k].name)] = number(material.parameters[k]);
    json["relaxation"] = Json::array();
    for (const RelaxationTerm& term : material.relaxation)
        json["relaxation"].push_back({{"amplitude", term.amplitude}, {"time_s", term.time_s}});
    return json;
}

Json supports_json(const SimulationResult& result) {
    Json list = Json::array();
    for (const SupportSet& set : result.prepared.supports)
        list.push_back({{"name", set.name},
                        {"kind", set.is_fix ? "fix" : "move"},
                        {"nodes", set.num_nodes},
                        {"degrees_of_freedom", set.dofs.size()},
                        {"displacement_mm", vector3(set.displacement_mm)},
                        {"column", column_json(result, set.column)}});
    return list;
}

Json forces_json(const SimulationResult& result) {
    Json list = Json::array();
    for (const ForceSettings& force : result.settings.forces)
        list.push_back({{"name", force.name},
                        {"kind", force.is_total ? "total" : "nodal"},
                        {"force_mn", vector3(force.force_mn)},
                        {"column", column_json(result, force.column)}});
    for (const SurfaceLoadSettings& load : result.settings.surface_loads)
        list.push_back({{"name", load.name},
                        {"kind", load.is_pressure ? "pressure" : "traction"},
                        {"pressure_kpa", number(load.pressure_kpa)},
                        {"traction_kpa", vector3(load.traction_kpa)},
                        {"column", column_json(result, load.column)}});
    return list;
}

Json obstacles_json(const SimulationResult& result) {
    Json list = Json::array();
    for (std::size_t k = 0; k < result.settings.obstacles.size(); ++k) {
        const ObstacleSettings& settings = result.settings.obstacles[k];
        const Contact& contact = result.prepared.model.contacts[k];
        list.push_back({{"name", settings.name},
                        {"shape", name_of(contact.obstacle.shape)},
                        {"place_mm", vector3(contact.obstacle.place)},
                        {"direction", vector3(contact.obstacle.direction)},
                        {"radius_mm", number(contact.obstacle.radius_mm)},
                        {"hollow", contact.obstacle.is_hollow},
                        {"friction", number(contact.friction)},
                        {"stiffness_kpa_per_mm", number(contact.stiffness_kpa_per_mm)},
                        {"slip_stiffness_kpa_per_mm", number(contact.slip_stiffness_kpa_per_mm)},
                        {"motion_mm", vector3(settings.motion_mm)},
                        {"faces", contact.faces.size()},
                        {"column", column_json(result, settings.column)}});
    }
    return list;
}

Json history_json(const SimulationResult& result) {
    if (!result.settings.history) return nullptr;
    const LoadTable& table = *result.settings.history;
    return {{"columns", table.columns}, {"time_s", table.time_s}, {"factors", table.factors}};
}

Json dynamics_json(const SimulationResult& result) {
    if (!result.settings.dynamics) return nullptr;
    const ExplicitOptions& options = *result.settings.dynamics;
    return {{"density_kg_per_m3", options.density_kg_per_m3},
            {"damping_per_s", options.damping_per_s},
            {"safety", options.safety},
            {"steps", result.num_explicit_steps},
            {"longest_step_s", number(result.longest_explicit_step_s)}};
}

Json settings_json(const SimulationResult& result) {
    Json materials = Json::array();
    for (std::size_t k = 0; k < result.settings.materials.size(); ++k)
        materials.push_back(
            material_json(result.settings.materials[k].material, result.prepared.labels[k]));
    const EquilibriumOptions& newton = result.settings.newton;
    return {{"mesh", mesh_json(result)},
            {"materials", materials},
            {"supports", supports_json(result)},
            {"forces", forces_json(result)},
            {"obstacles", obstacles_json(result)},
            {"history", history_json(result)},
            {"dynamics", dynamics_json(result)},
            {"newton",
             {{"relative_tolerance", newton.relative_tolerance},
              {"max_steps", newton.max_newton_steps},
              {"first_step", newton.first_step},
              {"smallest_step", newton.smallest_step},
              {"load_steps", result.settings.load_steps}}}};
}

Json step_json(const SimulationStep& step) {
    Json records = Json::array();
    for (const NewtonRecord& record : step.records)
        records.push_back({{"load", number(record.load)},
                           {"relative_residual", number(record.relative_residual)},
                           {"step_length", number(record.step_length)}});
    return {{"time", number(step.time_s)}, {"reached", number(step.reached_s)},
            {"converged", step.converged}, {"relative_residual", number(step.relative_residual)},
            {"message", step.message},     {"newton", records}};
}

Json state_json(const SimulationResult& result, std::size_t k) {
    const SimulationState& state = result.states[k];
    Json forces = Json::object();
    for (std::size_t h = 0; h < result.num_holders(); ++h)
        forces[result.holder_name(h)] = vector3(state.force_mn[h]);
    Json depths = Json::object();
    for (std::size_t c = 0; c < state.depth_mm.size(); ++c)
        depths[result.prepared.contact_names[c]] = number(state.depth_mm[c]);
    const VolumeChange volume = volume_change(result, state);
    return {{"time", number(state.time_s)},
            {"file", state_file_name(k)},
            {"largest_displacement_mm", number(largest_displacement(state).length_mm)},
            {"stored_energy_mn_mm", number(state.energy_mn_mm)},
            {"kinetic_energy_mn_mm", number(state.kinetic_energy_mn_mm)},
            {"volume_mm3", number(volume.after_mm3)},
            {"force_mn", forces},
            {"depth_in_obstacle_mm", depths}};
}

/// As in the result of `recover`.
Json solver_json(const std::optional<LinearSolverInfo>& solver) {
    if (!solver) return nullptr;
    return {{"method", name_of(solver->method)},
            {"library", solver->library},
            {"backend", solver->device.backend},
            {"device", solver->device.device},
            {"reason", solver->reason}};
}

Json loops_json(const std::optional<ElementLoopInfo>& loops) {
    if (!loops) return nullptr;
    return {{"backend", loops->device.backend},
            {"device", loops->device.device},
            {"reason", loops->reason}};
}

}  // namespace

std::string simulation_json(const SimulationResult& result) {
    Json json{{"program", "palpate"},
              {"version", version_text()},
              {"title", result.settings.title},
              {"kind", result.settings.dynamics    ? "motion"
                       : result.prepared.is_static ? "static"
                                                   : "history"},
              {"time_means", result.prepared.is_static ? "part of the load" : "seconds"},
              {"converged", result.converged()},
              {"message", convergence_sentence(result)},
              {"seconds", number(result.seconds)},
              {"linear_solver", solver_json(result.tangents)},
              {"element_loops", loops_json(result.loops)},
              {"settings", settings_json(result)}};
    for (const SimulationStep& step : result.steps) json["steps"].push_back(step_json(step));
    for (std::size_t k = 0; k < result.states.size(); ++k)
        json["states"].push_back(state_json(result, k));
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
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
