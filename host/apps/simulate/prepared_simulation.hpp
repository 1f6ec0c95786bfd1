// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/apps/simulate/simulation_settings.hpp"
#include "solver/equilibrium/time_steps.hpp"

namespace palpate {

/// Degrees of freedom that one [[fix]] or [[move]] holds; each belongs to the first that names it.
struct SupportSet {
    std::string name;
    bool is_fix = false;
    std::vector<Index> dofs;
    Vec3 displacement_mm = Vec3::Zero();  ///< at full load
    std::optional<std::size_t> column;
    Index num_nodes = 0;
};

/// A part of the loads that one column scales.
struct LoadPart {
    std::optional<std::size_t> column;
    SolidLoads full;
};

/// What a model file means on its mesh.
struct PreparedSimulation {
    SolidModel model;
    std::map<std::string, std::vector<double>> point_scalars;  ///< [num_nodes], of the mesh
    std::vector<Index> labels;                                 ///< [materials] file label of each
    std::vector<SupportSet> supports;
    std::vector<LoadPart> parts;
    std::vector<std::string> contact_names;  ///< [model.contacts]
    std::vector<double> time_s;  ///< that are solved for; of a static load 1, 2, ... load steps
    bool is_static = true;

    /// The loads of time number `step`.
    SolidLoads loads_at(const SimulationSettings& settings, std::size_t step) const;
};

/// Reads or makes the mesh, finds nodes and faces, and fills the model. A static model is given the
/// laws' own (long-term) stress. Throws Error as `read_solid_mesh` does, and
/// Error(invalid_argument) naming the table and line of the file that does not fit the mesh.
PreparedSimulation prepare_simulation(const SimulationSettings& settings);

}  // namespace palpate
