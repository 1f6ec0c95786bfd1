// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/read_loads.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "host/apps/simulate/selection.hpp"
#include "host/apps/simulate/setting_values.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t longest_name = 64;
constexpr std::array component_keys{"x_mm", "y_mm", "z_mm"};
constexpr const char* where_example = "which nodes, for example where = {side = \"z-min\"}";

std::string read_name(const SettingsTable& table, const std::string& otherwise) {
    const std::string name = table.text("name").value_or(otherwise);
    const bool is_plain = std::none_of(name.begin(), name.end(), [](unsigned char c) {
        return c < 0x20 || c == 0x7f || c == ',' || c == '"';
    });
    if (name.empty() || name.size() > longest_name || !is_plain)
        table.refuse("name", fmt::format("allowed: 1 to {} printable characters without commas and "
                                         "quotes, because columns of reactions.csv are called so",
                                         longest_name));
    return name;
}

std::optional<std::size_t> read_column(const SettingsTable& table,
                                       const std::optional<LoadTable>& history) {
    const auto name = table.text("column");
    if (!name) return std::nullopt;
    if (!history)
        table.refuse("column", "allowed only with a [history], which has the columns; add one");
    const auto& columns = history->columns;
    const auto found = std::find(columns.begin(), columns.end(), *name);
    if (found == columns.end())
        table.refuse(
            "column",
            fmt::format("allowed, because [history] has them: {}",
                        columns.empty() ? "none" : fmt::format("{}", fmt::join(columns, ", "))));
    return static_cast<std::size_t>(found - columns.begin());
}

/// Reads what all loads share; `keys` are those of the kind.
template <class Load>
Load read_load(SettingsTable table, const std::string& kind, std::size_t number,
               std::vector<std::string_view> keys, const std::optional<LoadTable>& history) {
    Load load;
    load.name = read_name(table, fmt::format("{} {}", kind, number));
    if (table.has("name")) table.set_subject(load.name);
    keys.insert(keys.begin(), {"name", "where", "column"});
    table.allow_keys(keys);
    if (const auto where = table.table("where")) load.where = read_selection(*where);
    if (!load.where && kind != "obstacle") table.missing("where", where_example);
    load.column = read_column(table, history);
    load.source = table;
    return load;
}

SupportSettings as_fix(SupportSettings support) {
    support.is_fix = true;
    const SettingsTable& table = support.source;
    if (table.has("column")) table.refuse("column", "what is fixed does not move; use [[move]]");
    const std::string components = table.text("components").value_or("xyz");
    for (const char c : components) {
        if (c < 'x' || c > 'z')
            table.refuse("components", "allowed: letters x, y, z, as in \"xy\"");
        support.displacement_mm[c - 'x'] = 0;
    }
    if (components.empty()) table.refuse("components", "allowed: at least one of x, y, z");
    return support;
}

SupportSettings as_move(SupportSettings support) {
    const SettingsTable& table = support.source;
    for (int c = 0; c < 3; ++c)
        support.displacement_mm[c] = table.number(component_keys[c], any_number);
    const auto& given = support.displacement_mm;
    if (std::none_of(given.begin(), given.end(), [](const auto& d) { return d.has_value(); }))
        table.missing("x_mm", "at least one of x_mm, y_mm, z_mm");
    return support;
}

ForceSettings as_force(ForceSettings force) {
    const SettingsTable& table = force.source;
    force.is_total = table.has("total_mn");
    if (force.is_total == table.has("nodal_mn"))
        table.fail("give one of total_mn (shared out among the nodes) and nodal_mn (on each)");
    force.force_mn = needed_vector(table, force.is_total ? "total_mn" : "nodal_mn");
    return force;
}

SurfaceLoadSettings as_pressure(SurfaceLoadSettings load) {
    load.is_pressure = true;
    load.pressure_kpa = needed_number(load.source, "kpa", any_number);
    load.follows = load.source.yes_or_no("follows").value_or(false);
    return load;
}

SurfaceLoadSettings as_traction(SurfaceLoadSettings load) {
    load.traction_kpa = needed_vector(load.source, "kpa");
    return load;
}

using Shapes = std::vector<ObstacleShape>;

/// What some shapes have and others have not.
const std::vector<std::pair<std::string_view, Shapes>>& keys_of_shapes() {
    using enum ObstacleShape;
    static const std::vector<std::pair<std::string_view, Shapes>> list{
        {"radius_mm", {cylinder, sphere, punch}},
        {"hollow", {cylinder, sphere}},
        {"hole_radius_mm", {tube}},
        {"edge_radius_mm", {tube, punch}},
        {"outer_radius_mm", {tube}},
        {"outer_edge_radius_mm", {tube}}};
    return list;
}

void read_edges(const SettingsTable& table, Obstacle& obstacle) {
    obstacle.edge_radius_mm = needed_number(table, "edge_radius_mm", positive);
    if (obstacle.shape == ObstacleShape::punch) {
        if (obstacle.edge_radius_mm > obstacle.radius_mm)
            table.refuse(
                "edge_radius_mm",
                fmt::format("allowed: at most radius_mm, {:g} mm, or the punch is narrower than "
                            "its edge",
                            obstacle.radius_mm));
        return;
    }
    obstacle.outer_radius_mm = needed_number(table, "outer_radius_mm", positive);
    obstacle.outer_edge_radius_mm =
        table.number("outer_edge_radius_mm", positive).value_or(obstacle.edge_radius_mm);
    const double least =
        obstacle.radius_mm + obstacle.edge_radius_mm + obstacle.outer_edge_radius_mm;
    if (obstacle.outer_radius_mm < least)
        table.refuse(
            "outer_radius_mm",
            fmt::format("allowed: at least hole_radius_mm and the radii of both edges together, "
                        "{:g} mm, or the rim is narrower than its edges",
                        least));
}

void read_sizes(const SettingsTable& table, Obstacle& obstacle) {
    for (const auto& [key, shapes] : keys_of_shapes())
        if (table.has(key) &&
            std::find(shapes.begin(), shapes.end(), obstacle.shape) == shapes.end())
            table.refuse(key, fmt::format("a {} has none; remove it", name_of(obstacle.shape)));
    if (obstacle.shape == ObstacleShape::plane) return;
    const bool is_tube = obstacle.shape == ObstacleShape::tube;
    obstacle.radius_mm = needed_number(table, is_tube ? "hole_radius_mm" : "radius_mm", positive);
    if (has_edge(obstacle.shape)) read_edges(table, obstacle);
    obstacle.is_hollow = table.yes_or_no("hollow").value_or(false);
}

ObstacleSettings as_obstacle(ObstacleSettings settings) {
    const SettingsTable& table = settings.source;
    const auto shape = table.choice("shape", {"plane", "cylinder", "sphere", "tube", "punch"});
    if (!shape) table.missing("shape", "\"plane\", \"cylinder\", \"sphere\", \"tube\", \"punch\"");
    Obstacle& obstacle = settings.obstacle;
    obstacle.shape = obstacle_shape_of(*shape);
    obstacle.place = needed_vector(table, "place_mm");
    if (obstacle.shape != ObstacleShape::sphere)
        obstacle.direction = needed_vector(table, "direction");
    read_sizes(table, obstacle);
    settings.friction = table.number("friction", not_negative).value_or(0);
    settings.stiffness_kpa_per_mm = table.number("stiffness_kpa_per_mm", positive);
    settings.slip_stiffness_kpa_per_mm = table.number("slip_stiffness_kpa_per_mm", positive);
    settings.motion_mm = vector_of(table, "motion_mm").value_or(Vec3::Zero());
    return settings;
}

void refuse_repeated_names(const SimulationSettings& settings) {
    std::vector<const LoadSettings*> loads;
    const auto add = [&](const auto& list) {
        for (const LoadSettings& load : list) {
            for (const LoadSettings* other : loads)
                if (other->name == load.name)
                    load.source.fail(fmt::format(
                        "another load is called '{}' too; give each a name of its own", load.name));
            loads.push_back(&load);
        }
    };
    add(settings.supports);
    add(settings.forces);
    add(settings.surface_loads);
    add(settings.obstacles);
}

}  // namespace

void read_loads(const SettingsTable& document, SimulationSettings& settings) {
    const auto read_all = [&](const char* kind, const std::vector<std::string_view>& keys,
                              auto&& finish, auto& list) {
        using Load = typename std::decay_t<decltype(list)>::value_type;
        std::size_t number = 0;
        for (const SettingsTable& table : document.tables(kind))
            list.push_back(finish(read_load<Load>(table, kind, ++number, keys, settings.history)));
    };
    read_all("fix", {"components"}, as_fix, settings.supports);
    read_all("move", {"x_mm", "y_mm", "z_mm"}, as_move, settings.supports);
    read_all("force", {"total_mn", "nodal_mn"}, as_force, settings.forces);
    read_all("pressure", {"kpa", "follows"}, as_pressure, settings.surface_loads);
    read_all("traction", {"kpa"}, as_traction, settings.surface_loads);
    read_all("obstacle",
             {"shape", "place_mm", "direction", "radius_mm", "hole_radius_mm", "edge_radius_mm",
              "outer_radius_mm", "outer_edge_radius_mm", "hollow", "friction",
              "stiffness_kpa_per_mm", "slip_stiffness_kpa_per_mm", "motion_mm"},
             as_obstacle, settings.obstacles);
    refuse_repeated_names(settings);
}

}  // namespace palpate
