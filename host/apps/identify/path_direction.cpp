// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/path_direction.hpp"

#include <cstddef>
#include <regex>

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

}  // namespace

std::optional<HistoryDirection> direction_of(const std::string& path,
                                             const PreparedSimulation& prepared,
                                             const SimulationSettings& settings) {
    static const std::regex of_relaxation(
        R"(material\[(\d+)\]\.relaxation\[(\d+)\]\.(amplitude|time_s))");
    static const std::regex of_material(R"(material\[(\d+)\]\.(\w+))");
    static const std::regex of_friction(R"(obstacle\[(\d+)\]\.friction)");
    static const std::regex of_size(R"(obstacle\[(\d+)\]\.(\w+_mm))");
    const SolidModel& model = prepared.model;
    std::smatch found;
    if (std::regex_match(path, found, of_relaxation)) {
        const std::size_t material = index_of(found[1]), term = index_of(found[2]);
        if (model.materials[material].relaxation.empty()) return std::nullopt;  // a static load
        return found[3] == "time_s" ? along_relaxation_time(model, material, term)
                                    : along_amplitude(model, material, term);
    }
    if (std::regex_match(path, found, of_material)) {
        const std::size_t material = index_of(found[1]);
        const auto parameter = parameter_named(model.materials[material], found[2]);
        if (parameter) return along_parameter(model, material, *parameter);
    }
    if (std::regex_match(path, found, of_friction)) {
        const std::size_t contact = index_of(found[1]);
        if (model.contacts[contact].friction > 0) return along_friction(model, contact);
    }
    if (std::regex_match(path, found, of_size)) {
        const std::size_t contact = index_of(found[1]);
        const int size = size_named(found[2]);
        if (size < 0) return std::nullopt;
        HistoryDirection direction = along_size(model, contact, size);
        // The outer edge is as round as the inner one where the file does not say.
        const bool is_both = found[2] == "edge_radius_mm" &&
                             model.contacts[contact].obstacle.shape == ObstacleShape::tube &&
                             !settings.obstacles[contact].source.has("outer_edge_radius_mm");
        if (is_both) direction.sizes[contact][3] = 1;
        return direction;
    }
    return std::nullopt;
}

}  // namespace palpate
