// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/path_direction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <regex>
#include <utility>
#include <vector>

#include "host/apps/simulate/prepare_obstacles.hpp"
#include "host/apps/simulate/selection.hpp"
#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

/// Which of `obstacle_sizes` a key of an obstacle is; -1: none.
int size_named(const std::string& key) {
    if (key == "hole_radius_mm") return 0;
    for (std::size_t k = 0; k < obstacle_sizes.size(); ++k)
        if (key == obstacle_sizes[k]) return static_cast<int>(k);
    return -1;
}

/// A number in a path, less one: lists are counted from 1 there.
std::size_t index_of(const std::ssub_match& text) { return std::stoul(text.str()) - 1; }

std::optional<std::size_t> parameter_named(const SolidMaterial& material, const std::string& name) {
    const auto& parameters = material_law(material.law).parameters;
    for (std::size_t k = 0; k < parameters.size(); ++k)
        if (parameters[k].name == name) return k;
    return std::nullopt;
}

/// Whether a size of an obstacle is one of the mesh, too: of the tube that its edge is of.
bool moves_mesh(const SimulationSettings& settings, std::size_t contact, int size) {
    const auto& graded = settings.mesh.graded;
    return graded && graded->face && settings.obstacles[contact].name == graded->edge_of &&
           (size == size_named("hole_radius_mm") || size == size_named("edge_radius_mm"));
}

/// Penalties of obstacles for which the file gives none, with these materials: [contacts].
std::vector<Eigen::Vector2d> penalties_of(const PreparedSimulation& prepared,
                                          const SimulationSettings& settings,
                                          const std::vector<SolidMaterial>& materials) {
    const SelectableMesh in{prepared.model.mesh, prepared.point_scalars};
    std::vector<Eigen::Vector2d> penalties;
    for (const ObstacleSettings& obstacle : settings.obstacles) {
        if (obstacle.stiffness_kpa_per_mm) {  // that on slip is given or the same
            penalties.emplace_back(Eigen::Vector2d::Zero());
            continue;
        }
        const Contact contact = contact_of(obstacle, in, materials);
        penalties.emplace_back(contact.stiffness_kpa_per_mm, contact.slip_stiffness_kpa_per_mm);
    }
    return penalties;
}

/// A number of a material: penalties that follow the stiffest tissue follow it too,
///   dk/dp ~ (k(p + h) - k(p - h)) / 2h,   with one side where the law does not allow the other.
HistoryDirection with_penalties(HistoryDirection direction, const PreparedSimulation& prepared,
                                const SimulationSettings& settings, double value,
                                const ParameterRange& range,
                                const std::function<double&(std::vector<SolidMaterial>&)>& number) {
    if (settings.obstacles.empty()) return direction;
    const double h = 1e-5 * std::max(std::abs(value), 1e-3);
    const double above = range.contains(value + h) ? h : 0;
    const double below = range.contains(value - h) ? h : 0;
    if (above + below == 0) return direction;
    std::vector<SolidMaterial> materials;
    for (const MaterialSettings& one : settings.materials) materials.push_back(one.material);
    const auto at = [&](double moved) {
        number(materials) = moved;
        return penalties_of(prepared, settings, materials);
    };
    const auto more = at(value + above), less = at(value - below);
    for (std::size_t c = 0; c < more.size(); ++c)
        direction.penalties.emplace_back((more[c] - less[c]) / (above + below));
    return direction;
}

/// a - b, of loads of one model.
SolidLoads difference(SolidLoads a, const SolidLoads& b) {
    a.displacement -= b.displacement;
    a.force -= b.force;
    for (std::size_t k = 0; k < a.obstacle_motion.size(); ++k)
        a.obstacle_motion[k] -= b.obstacle_motion[k];
    for (std::size_t k = 0; k < a.pressure_kpa.size(); ++k) a.pressure_kpa[k] -= b.pressure_kpa[k];
    return a;
}

SolidLoads divided(SolidLoads loads, double by) {
    loads.displacement /= by;
    loads.force /= by;
    for (Vec3& motion : loads.obstacle_motion) motion /= by;
    for (double& pressure : loads.pressure_kpa) pressure /= by;
    return loads;
}

/// A number of the shape, mm: the models on both sides of it are compared, and their loads. Empty
/// where these have other nodes, or one of them cannot be made.
std::optional<HistoryDirection> along_shape(
    const std::string& path, const PreparedSimulation& prepared,
    const std::function<SimulationSettings(double by)>& moved) {
    constexpr double half_step_mm = 1e-5;
    const std::size_t num_times = prepared.time_s.size();
    ModelPair pair{{}, 2 * half_step_mm};
    std::array<std::vector<SolidLoads>, 2> loads;
    try {
        for (const int side : {0, 1}) {
            const SimulationSettings settings = moved(side == 0 ? -half_step_mm : half_step_mm);
            PreparedSimulation other = prepare_simulation(settings);
            if (other.model.num_dofs() != prepared.model.num_dofs()) return std::nullopt;
            for (std::size_t step = 0; step < num_times; ++step)
                loads[side].push_back(other.loads_at(settings, step));
            pair.models[side] = std::make_shared<const SolidModel>(std::move(other.model));
        }
        HistoryDirection direction = along_pair(prepared.model, std::move(pair));
        direction.name = path;
        for (std::size_t step = 0; step < num_times; ++step)
            direction.loads.push_back(
                divided(difference(loads[1][step], loads[0][step]), 2 * half_step_mm));
        return direction;
    } catch (const Error& error) {
        const bool is_of_shape = error.code() == ErrorCode::invalid_argument ||
                                 error.code() == ErrorCode::mesh_failed ||
                                 error.code() == ErrorCode::input_unusable;
        if (!is_of_shape) throw;
        return std::nullopt;
    }
}

/// All loads are linear in the size of each: dL/dp = L(p + 1) - L(p) at every time.
HistoryDirection along_load(const std::string& path, const PreparedSimulation& prepared,
                            const SimulationSettings& settings, const SimulationSettings& larger) {
    const PreparedSimulation other = prepare_simulation(larger);
    HistoryDirection direction;
    direction.name = path;
    for (std::size_t step = 0; step < prepared.time_s.size(); ++step)
        direction.loads.push_back(
            difference(other.loads_at(larger, step), prepared.loads_at(settings, step)));
    return direction;
}

}  // namespace

std::optional<HistoryDirection> direction_of(
    const std::string& path, const PreparedSimulation& prepared, const SimulationSettings& settings,
    const std::function<SimulationSettings(double by)>& moved) {
    static const std::regex of_relaxation(
        R"(material\[(\d+)\]\.relaxation\[(\d+)\]\.(amplitude|time_s))");
    static const std::regex of_material(R"(material\[(\d+)\]\.(\w+))");
    static const std::regex of_friction(R"(obstacle\[(\d+)\]\.friction)");
    static const std::regex of_size(R"(obstacle\[(\d+)\]\.(\w+_mm))");
    static const std::regex of_load(
        R"(move\[\d+\]\.[xyz]_mm|force\[\d+\]\.(total|nodal)_mn\[\d+\]|pressure\[\d+\]\.kpa|)"
        R"(traction\[\d+\]\.kpa\[\d+\]|obstacle\[\d+\]\.motion_mm\[\d+\])");
    static const std::regex of_shape(R"(mesh\.(graded|rectangle|box)\..*)");
    const SolidModel& model = prepared.model;
    std::smatch found;
    if (std::regex_match(path, found, of_relaxation)) {
        const std::size_t material = index_of(found[1]), term = index_of(found[2]);
        if (model.materials[material].relaxation.empty()) return std::nullopt;  // a static load
        if (found[3] == "time_s") return along_relaxation_time(model, material, term);
        return with_penalties(along_amplitude(model, material, term), prepared, settings,
                              model.materials[material].relaxation[term].amplitude, {},
                              [&](std::vector<SolidMaterial>& of) -> double& {
                                  return of[material].relaxation[term].amplitude;
                              });
    }
    if (std::regex_match(path, found, of_material)) {
        const std::size_t material = index_of(found[1]);
        const auto parameter = parameter_named(model.materials[material], found[2]);
        if (parameter)
            return with_penalties(
                along_parameter(model, material, *parameter), prepared, settings,
                model.materials[material].parameters[*parameter],
                material_law(model.materials[material].law).parameters[*parameter].range,
                [&](std::vector<SolidMaterial>& of) -> double& {
                    return of[material].parameters[*parameter];
                });
    }
    if (std::regex_match(path, found, of_friction)) {
        const std::size_t contact = index_of(found[1]);
        if (model.contacts[contact].friction > 0) return along_friction(model, contact);
    }
    if (std::regex_match(path, found, of_size)) {
        const std::size_t contact = index_of(found[1]);
        const int size = size_named(found[2]);
        if (size < 0) return std::nullopt;
        if (moves_mesh(settings, contact, size)) return along_shape(path, prepared, moved);
        HistoryDirection direction = along_size(model, contact, size);
        // The outer edge is as round as the inner one where the file does not say.
        const bool is_both = found[2] == "edge_radius_mm" &&
                             model.contacts[contact].obstacle.shape == ObstacleShape::tube &&
                             !settings.obstacles[contact].source.has("outer_edge_radius_mm");
        if (is_both) direction.sizes[contact][3] = 1;
        return direction;
    }
    if (std::regex_match(path, of_shape)) return along_shape(path, prepared, moved);
    if (std::regex_match(path, of_load)) return along_load(path, prepared, settings, moved(1));
    return std::nullopt;
}

}  // namespace palpate
