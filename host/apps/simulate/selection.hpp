// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/apps/simulate/simulation_settings.hpp"

namespace palpate {

/// Reads the keys of a `where = {...}` table. Throws Error(invalid_argument).
Selection read_selection(const SettingsTable& table);

/// A mesh and the arrays that selections may name.
struct SelectableMesh {
    const SolidMesh& mesh;
    const std::map<std::string, std::vector<double>>& point_scalars;  ///< [num_nodes]
};

/// [num_nodes] 1 where a node is meant. Throws Error(invalid_argument) if there is none, or no such
/// array.
std::vector<std::uint8_t> selected_nodes(const Selection& selection, const SelectableMesh& in);

/// The boundary faces all of whose nodes are meant. Throws Error(invalid_argument) if there is
/// none.
std::vector<Face> selected_faces(const Selection& selection, const SelectableMesh& in);

/// [num_elements] 1 where the centre of the corners is meant. Throws Error(invalid_argument) if
/// there is none, and for criteria that only a node can meet.
std::vector<std::uint8_t> selected_elements(const Selection& selection, const SolidMesh& mesh);

}  // namespace palpate
