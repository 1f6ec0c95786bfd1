// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "host/apps/simulate/read_loads.hpp"
#include "host/apps/simulate/selection.hpp"
#include "host/apps/simulate/setting_values.hpp"
#include "host/apps/simulate/simulation_settings.hpp"
#include "host/io/files.hpp"
#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_file_bytes = 16 << 20;
constexpr std::size_t longest_title = 120;
constexpr int largest_label = 65535;
constexpr int most_divisions = 1000;

std::array<int, 3> read_divisions(const SettingsTable& table, std::size_t dimension) {
    const auto values = table.numbers("divisions", dimension, dimension);
    if (!values) table.missing("divisions", "how many cells along each edge");
    std::array<int, 3> divisions{1, 1, 1};
    for (std::size_t k = 0; k < dimension; ++k) {
        const double value = (*values)[k];
        if (!(value >= 1 && value <= most_divisions) || value != static_cast<int>(value))
            table.refuse("divisions",
                         fmt::format("allowed: whole numbers from 1 to {}", most_divisions));
        divisions[k] = static_cast<int>(value);
    }
    return divisions;
}

GridSettings read_grid(const SettingsTable& table, bool is_solid) {
    std::vector<std::string_view> keys{"size_mm", "divisions", "origin_mm"};
    if (!is_solid) keys.push_back("element");
    table.allow_keys(keys);
    const std::size_t dimension = is_solid ? 3 : 2;
    GridSettings grid;
    const auto size = table.numbers("size_mm", dimension, dimension);
    if (!size) table.missing("size_mm", fmt::format("{} lengths in mm", dimension));
    for (std::size_t k = 0; k < dimension; ++k) {
        if (!((*size)[k] > 0)) table.refuse("size_mm", "allowed: lengths greater than 0 mm");
        grid.size_mm[k] = (*size)[k];
    }
    if (const auto origin = table.numbers("origin_mm", dimension, dimension))
        std::copy(origin->begin(), origin->end(), grid.origin_mm.data());
    grid.divisions = read_divisions(table, dimension);
    if (!is_solid)
        grid.type = element_type_of(table.choice("element", {"quad4", "tri3"}).value_or("quad4"));
    return grid;
}

/// x ascends, y at each of them.
void read_surface(const SettingsTable& table, GradedSettings& graded) {
    const auto x = table.numbers("surface_x_mm", 3, 1000);
    const auto y = table.numbers("surface_y_mm", 3, 1000);
    if (!x && !y) return;
    if (!x || !y || x->size() != y->size())
        table.fail("surface_x_mm and surface_y_mm need as many numbers, at least three each");
    if (!std::is_sorted(x->begin(), x->end(), std::less_equal<>()))
        table.refuse("surface_x_mm", "allowed: ascending numbers");
    graded.surface_x_mm = *x;
    graded.surface_y_mm = *y;
}

GradedSettings read_graded(const SettingsTable& table) {
    table.allow_keys({"width_mm", "depth_mm", "edge_mm", "edge_of", "columns_inside",
                      "columns_outside", "rows", "finest_mm", "surface_x_mm", "surface_y_mm",
                      "refine"});
    GradedSettings graded;
    graded.width_mm = needed_number(table, "width_mm", positive);
    graded.depth_mm = needed_number(table, "depth_mm", positive);
    graded.edge_of = table.text("edge_of").value_or("");
    if (graded.edge_of.empty())
        graded.edge_mm = needed_number(table, "edge_mm", positive);
    else if (table.has("edge_mm"))
        table.refuse("edge_mm", "give either edge_mm or edge_of");
    const auto count = [&](const char* key, int& value) {
        value = table.whole_number(key, 2, most_divisions).value_or(value);
    };
    count("columns_inside", graded.columns_inside);
    count("columns_outside", graded.columns_outside);
    count("rows", graded.rows);
    graded.finest_mm = table.number("finest_mm", positive).value_or(graded.finest_mm);
    graded.refine = table.whole_number("refine", 1, 16).value_or(graded.refine);
    read_surface(table, graded);
    return graded;
}

Index read_label(const SettingsTable& table) {
    const auto label = table.whole_number("region", 0, largest_label);
    if (!label) table.missing("region", "a whole number, the label of cells");
    return *label;
}

PartSettings read_part(const SettingsTable& table) {
    table.allow_keys({"region", "where"});
    const auto where = table.table("where");
    if (!where) table.missing("where", "where = {centre_mm = [...], radius_mm = ...}, for example");
    return {read_label(table), read_selection(*where)};
}

void read_mesh_source(const SettingsTable& table, const fs::path& folder, MeshSettings& mesh) {
    const bool is_solid = mesh.formulation == Formulation::solid;
    if (const auto graded = table.table("graded")) {
        if (is_solid) table.refuse("graded", "it is made in a plane or about an axis");
        for (const char* key : {"file", "region_array", "unit", "rectangle", "box"})
            if (table.has(key)) table.refuse(key, "it does not go with a graded mesh; remove it");
        mesh.graded = read_graded(*graded);
        return;
    }
    const char* generator = is_solid ? "box" : "rectangle";
    const char* other = is_solid ? "rectangle" : "box";
    if (table.has(other))
        table.refuse(other, fmt::format("the formulation is \"{}\", which takes a {}",
                                        name_of(mesh.formulation), generator));
    if (table.has("file") == table.has(generator))
        table.fail(
            fmt::format("give either file = \"mesh.vtu\" or {0} = {{size_mm = [...], "
                        "divisions = [...]}}",
                        generator));
    if (const auto grid = table.table(generator)) {
        if (table.has("region_array"))
            table.refuse("region_array", "it goes with a file; use [[mesh.part]] here");
        if (table.has("unit")) table.refuse("unit", "it goes with a file; grids are in mm");
        mesh.grid = read_grid(*grid, is_solid);
    } else {
        mesh.file = folder / *table.text("file");
        if (const auto why = why_unreadable(mesh.file))
            throw Error(ErrorCode::input_unreadable,
                        fmt::format("cannot read the mesh '{}': {}; check 'file' in [mesh]",
                                    mesh.file.string(), *why));
        mesh.region_array = table.text("region_array");
        const std::string unit = table.choice("unit", {"mm", "cm", "m"}).value_or("mm");
        mesh.mm_per_unit = unit == "m" ? 1000 : unit == "cm" ? 10 : 1;
    }
}

MeshSettings read_mesh(const SettingsTable& table, const fs::path& folder) {
    table.allow_keys({"file", "region_array", "unit", "box", "rectangle", "graded", "part",
                      "formulation", "thickness_mm", "quadratic", "volume"});
    MeshSettings mesh;
    mesh.source = table;
    mesh.formulation = formulation_of(
        table.choice("formulation", {"solid", "plane-strain", "plane-stress", "axisymmetric"})
            .value_or("solid"));
    const bool is_slice = mesh.formulation == Formulation::plane_strain ||
                          mesh.formulation == Formulation::plane_stress;
    if (table.has("thickness_mm") && !is_slice)
        table.refuse("thickness_mm", "it goes with plane-strain and plane-stress; remove it");
    mesh.thickness_mm = table.number("thickness_mm", positive).value_or(1);
    read_mesh_source(table, folder, mesh);
    for (const SettingsTable& part : table.tables("part")) mesh.parts.push_back(read_part(part));
    mesh.quadratic = table.yes_or_no("quadratic").value_or(false);
    const auto volume = table.choice("volume", {"pointwise", "element-mean"});
    if (volume && *volume == "element-mean") {
        if (mesh.formulation == Formulation::plane_stress)
            table.refuse("volume",
                         "in plane stress the volume follows from the law; allowed: "
                         "\"pointwise\"");
        mesh.volume = VolumeTreatment::element_mean;
    }
    return mesh;
}

/// The law of a material table; a mistake is shown with those that there are.
const MaterialDescription& read_law(const SettingsTable& table) {
    std::string names;
    for (const MaterialDescription& law : material_laws())
        names += (names.empty() ? "\"" : ", \"") + std::string(law.name) + "\"";
    const auto name = table.text("law");
    if (!name) table.missing("law", names);
    for (const MaterialDescription& law : material_laws())
        if (law.name == *name) return law;
    table.refuse("law", "allowed: " + names);
}

void read_relaxation(const SettingsTable& table, SolidMaterial& material) {
    for (const SettingsTable& term : table.tables("relaxation")) {
        term.allow_keys({"amplitude", "time_s"});
        material.relaxation.push_back({needed_number(term, "amplitude", not_negative),
                                       needed_number(term, "time_s", positive)});
    }
    for (const char* key : {"relaxation_of", "instantaneous"})
        if (material.relaxation.empty() && table.has(key))
            table.refuse(key, "it goes with relaxation = [{amplitude = ..., time_s = ...}]");
    material.relaxation_of = relaxation_of_name(
        table.choice("relaxation_of", {"isochoric", "total"}).value_or("isochoric"));
    material.is_instantaneous = table.yes_or_no("instantaneous").value_or(false);
}

/// What a static load does with moduli of a sudden strain would depend on how fast it came.
void refuse_instantaneous(const std::vector<MaterialSettings>& materials) {
    for (const MaterialSettings& material : materials)
        if (material.material.is_instantaneous)
            material.source.refuse(
                "instantaneous",
                "a load without [history] meets the long-term law; give that (moduli at t = 0 "
                "over 1 + the sum of amplitudes), or a [history]");
}

NumberRange number_range(const ParameterRange& range) {
    const auto inward = [](double end, bool is_included, double other) {
        return is_included || !std::isfinite(end) ? end : std::nextafter(end, other);
    };
    return {std::max(any_number.low, range.lowest),
            std::min(any_number.high, inward(range.highest, range.includes_highest, 0)),
            !range.includes_lowest && std::isfinite(range.lowest)};
}

MaterialSettings read_material(const SettingsTable& table) {
    const MaterialDescription& law = read_law(table);
    std::vector<std::string_view> keys{"region", "law", "relaxation", "relaxation_of",
                                       "instantaneous"};
    for (const MaterialParameter& parameter : law.parameters) keys.push_back(parameter.name);
    table.allow_keys(keys);
    MaterialSettings settings;
    settings.source = table;
    if (table.has("region")) settings.region = read_label(table);
    settings.material.law = law.name;
    for (const MaterialParameter& parameter : law.parameters) {
        const std::string allowed = allowed_text(parameter);
        if (!table.has(parameter.name)) table.missing(parameter.name, allowed);
        const auto value = table.number(parameter.name, number_range(parameter.range), allowed);
        settings.material.parameters.push_back(*value);
    }
    read_relaxation(table, settings.material);
    return settings;
}

void read_newton(const SettingsTable& table, SimulationSettings& settings) {
    table.allow_keys(
        {"relative_tolerance", "max_steps", "first_step", "smallest_step", "load_steps"});
    EquilibriumOptions& newton = settings.newton;
    newton.relative_tolerance =
        table.number("relative_tolerance", {1e-14, 0.1}).value_or(newton.relative_tolerance);
    newton.max_newton_steps =
        table.whole_number("max_steps", 1, 10000).value_or(newton.max_newton_steps);
    newton.first_step = table.number("first_step", {0, 1, true}).value_or(newton.first_step);
    newton.smallest_step =
        table.number("smallest_step", {0, 1, true}).value_or(newton.smallest_step);
    if (newton.smallest_step > newton.first_step)
        table.refuse(table.has("smallest_step") ? "smallest_step" : "first_step",
                     fmt::format("allowed: smallest_step ({:g}) at most first_step ({:g})",
                                 newton.smallest_step, newton.first_step));
    settings.load_steps = table.whole_number("load_steps", 1, 10000).value_or(1);
    if (settings.history && table.has("load_steps"))
        table.refuse("load_steps", "with a [history] its rows are the steps; remove it");
}

void read_dynamics(const SettingsTable& table, SimulationSettings& settings) {
    table.allow_keys({"density_kg_per_m3", "damping_per_s", "safety"});
    if (!settings.history) table.fail("a motion needs a [history] of its loads; add one");
    ExplicitOptions options;
    options.density_kg_per_m3 =
        table.number("density_kg_per_m3", positive).value_or(options.density_kg_per_m3);
    options.damping_per_s =
        table.number("damping_per_s", not_negative).value_or(options.damping_per_s);
    options.safety = table.number("safety", {0, 0.999, true}).value_or(options.safety);
    settings.dynamics = options;
}

/// The edge of a graded mesh that is that of a tube.
void set_edge_of_tube(const SettingsTable& mesh, SimulationSettings& settings) {
    GradedSettings& graded = *settings.mesh.graded;
    for (const ObstacleSettings& one : settings.obstacles) {
        const Obstacle& tube = one.obstacle;
        if (one.name != graded.edge_of || tube.shape != ObstacleShape::tube) continue;
        if (!tube.place.isZero(0) || tube.direction != Vec3(0, -1, 0))
            one.source.fail(
                "the mesh's edge is that of this tube, which so has to have place_mm = [0, 0] and "
                "direction = [0, -1]");
        graded.face = TubeFace{tube.radius_mm, tube.edge_radius_mm};
        graded.edge_mm = graded.face->end_mm();
        return;
    }
    mesh.table("graded")->refuse("edge_of",
                                 "allowed: the name of an [[obstacle]] of shape \"tube\"");
}

std::string read_title(const SettingsTable& document) {
    const std::string title = document.text("title").value_or("");
    if (title.size() > longest_title)
        document.refuse("title", fmt::format("allowed: at most {} characters", longest_title));
    return title;
}

}  // namespace

std::vector<std::string_view> simulation_keys() {
    std::vector<std::string_view> keys{"title",   "mesh",   "material",
                                       "history", "newton", "dynamics"};
    keys.insert(keys.end(), load_keys.begin(), load_keys.end());
    return keys;
}

std::vector<MaterialSettings> read_materials(const SettingsTable& document) {
    std::vector<MaterialSettings> materials;
    const std::vector<SettingsTable> tables = document.tables("material");
    if (tables.empty()) document.fail("there is no [[material]]; say what the body is made of");
    for (const SettingsTable& table : tables) {
        const MaterialSettings material = read_material(table);
        if (!material.region && tables.size() > 1)
            table.missing("region", "a label, because there are several materials");
        for (const MaterialSettings& other : materials)
            if (other.region == material.region)
                table.refuse("region", "another [[material]] has it; labels must differ");
        materials.push_back(material);
    }
    return materials;
}

SimulationSettings parse_simulation(const std::string& toml, const std::string& source_name,
                                    const fs::path& folder) {
    const SettingsTable document = SettingsTable::parse(toml, source_name);
    document.allow_keys(simulation_keys());
    return simulation_of(document, folder);
}

SimulationSettings simulation_of(const SettingsTable& document, const fs::path& folder) {
    SimulationSettings settings;
    settings.title = read_title(document);
    const auto mesh = document.table("mesh");
    if (!mesh) document.fail("there is no [mesh]; give a file, a box or a rectangle");
    settings.mesh = read_mesh(*mesh, folder);
    settings.materials = read_materials(document);
    if (const auto history = document.table("history"))
        settings.history = read_history(*history, folder);
    else
        refuse_instantaneous(settings.materials);
    read_loads(document, settings);
    if (settings.mesh.graded && !settings.mesh.graded->edge_of.empty())
        set_edge_of_tube(*mesh, settings);
    if (const auto newton = document.table("newton")) read_newton(*newton, settings);
    if (const auto dynamics = document.table("dynamics")) {
        if (document.has("newton"))
            document.refuse("newton", "a motion has no Newton steps; remove it");
        read_dynamics(*dynamics, settings);
    }
    return settings;
}

std::string text_of_model(const fs::path& path) {
    const auto refuse = [&](const std::string& why) {
        throw Error(
            ErrorCode::input_unreadable,
            fmt::format("cannot read the model '{}': {}; check the path", path.string(), why));
    };
    if (const auto why = why_unreadable(path)) refuse(*why);
    std::error_code failed;
    if (fs::file_size(path, failed) > largest_file_bytes) refuse("it is larger than 16 MiB");
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

SimulationSettings read_simulation(const fs::path& path) {
    return parse_simulation(text_of_model(path), path.filename().string(), path.parent_path());
}

}  // namespace palpate
