// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/apps/recover/result/recovery_result.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate {

struct ModelRegion {
    std::string name;   ///< as in the settings
    std::string token;  ///< the same in letters, digits and '_', with a letter in front; unique
    Index label = 0;
    double stiffness_kpa = 0, poisson_ratio = 0;
    std::vector<Index> tets;  ///< ascending
};

/// What a recovery found, as a forward problem that other programs can solve: the reference at
/// rest, what its tissue is, what holds and moves it, and the answer.
struct RecoveredModel {
    Mesh mesh;                         ///< mm LPS; `region` holds labels
    std::vector<ModelRegion> regions;  ///< those with tetrahedra
    TissueLaw law;
    std::vector<Held> held;          ///< [num_nodes]
    std::vector<Vec3> displacement;  ///< [num_nodes] mm
    std::vector<Vec3> force;         ///< [num_nodes] mN, zero at free nodes
    std::string version;             ///< of the palpate that made it

    std::vector<Index> nodes_that_are(Held kind) const;
    /// "modulus 12.3 kPa" and so on, of one region, for the comments of a file.
    std::string description_of(const ModelRegion& region) const;
};

/// Reads mesh.vtu and result.json of a result folder. Throws Error(input_unreadable) (missing,
/// damaged), Error(input_unusable) (from a palpate that did not write what holds the nodes),
/// Error(unsupported) for other elements than tet4.
RecoveredModel read_recovered_model(const std::filesystem::path& folder);

}  // namespace palpate
