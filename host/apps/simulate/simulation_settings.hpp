// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/simulate/graded_mesh.hpp"
#include "host/apps/simulate/load_table.hpp"
#include "host/io/settings_table.hpp"
#include "solver/equilibrium/explicit_steps.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// Which nodes (or faces all of whose nodes) are meant: those that satisfy all that is given.
struct Selection {
    SettingsTable source;             ///< for complaints
    std::optional<std::string> side;  ///< "x-min" to "z-max" of the mesh
    std::optional<Vec3> from_mm, to_mm;
    std::optional<Vec3> centre_mm;
    double radius_mm = 0;
    std::optional<Vec3> point_mm;
    Vec3 normal = Vec3::UnitZ();
    std::optional<std::string> point_array;
    std::optional<double> value;  ///< of the point array; empty: anything but 0
    std::optional<double> tolerance_mm;
};

/// A mesh made here: a box of tetrahedra or a rectangle of triangles or quadrilaterals.
struct GridSettings {
    Vec3 origin_mm = Vec3::Zero();
    Vec3 size_mm = Vec3::Ones();
    std::array<int, 3> divisions{1, 1, 1};
    ElementType type = ElementType::tet4;
};

/// Elements whose centre satisfies `where` get the label `region`.
struct PartSettings {
    Index region = 1;
    Selection where;
};

struct MeshSettings {
    SettingsTable source;
    std::filesystem::path file;  ///< empty: `grid`
    std::optional<std::string> region_array;
    double mm_per_unit = 1;  ///< of the file's coordinates
    GridSettings grid;
    std::optional<GradedSettings> graded;  ///< in place of `grid`
    std::vector<PartSettings> parts;
    Formulation formulation = Formulation::solid;
    double thickness_mm = 1;
    bool quadratic = false;
    VolumeTreatment volume = VolumeTreatment::pointwise;
};

struct MaterialSettings {
    SettingsTable source;
    std::optional<Index> region;  ///< file label; empty: the whole mesh
    SolidMaterial material;
};

/// What all loads share.
struct LoadSettings {
    SettingsTable source;
    std::string name;
    std::optional<Selection> where;
    std::optional<std::size_t> column;  ///< of the history; empty: full load at all times
};

/// Displacements of some components are given.
struct SupportSettings : LoadSettings {
    std::array<std::optional<double>, 3> displacement_mm;
    bool is_fix = false;  ///< all that is given is 0
};

struct ForceSettings : LoadSettings {
    Vec3 force_mn = Vec3::Zero();
    bool is_total = true;  ///< shared out among the nodes in equal parts; else on each of them
};

struct SurfaceLoadSettings : LoadSettings {
    bool is_pressure = false;
    double pressure_kpa = 0;  ///< against the outward normal
    bool follows = false;     ///< the surface as it deforms; else constant area and direction
    Vec3 traction_kpa = Vec3::Zero();
};

struct ObstacleSettings : LoadSettings {
    Obstacle obstacle;
    std::optional<double> stiffness_kpa_per_mm, slip_stiffness_kpa_per_mm;
    double friction = 0;
    Vec3 motion_mm = Vec3::Zero();
};

/// Everything a model file says, checked as far as that goes without the mesh.
struct SimulationSettings {
    std::string title;
    MeshSettings mesh;
    std::vector<MaterialSettings> materials;
    std::vector<SupportSettings> supports;
    std::vector<ForceSettings> forces;
    std::vector<SurfaceLoadSettings> surface_loads;
    std::vector<ObstacleSettings> obstacles;
    std::optional<LoadTable> history;  ///< empty: one static load
    int load_steps = 1;                ///< equal parts of the static load
    EquilibriumOptions newton;
    std::optional<ExplicitOptions> dynamics;  ///< empty: inertia is left out
};

/// Reads a model file in TOML. Throws Error(input_unreadable) (missing or not TOML, with line) and
/// Error(invalid_argument) naming file, line, table, key, value and what is allowed; unknown keys
/// are errors.
SimulationSettings read_simulation(const std::filesystem::path& path);
/// `folder`: that relative file names start from.
SimulationSettings parse_simulation(const std::string& toml, const std::string& source_name,
                                    const std::filesystem::path& folder);

// The same in parts, for applications whose files hold more than a model:
/// The text of a model file. Throws Error(input_unreadable).
std::string text_of_model(const std::filesystem::path& path);
/// The keys of a model file.
std::vector<std::string_view> simulation_keys();
/// [[material]] of `document`, at least one.
std::vector<MaterialSettings> read_materials(const SettingsTable& document);
/// What the keys of a model file say in `document`; others are not looked at.
SimulationSettings simulation_of(const SettingsTable& document,
                                 const std::filesystem::path& folder);

}  // namespace palpate
