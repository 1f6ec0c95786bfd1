// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/apps/recover/pipeline/segmentation.hpp"
#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// What the search found, as bytes: all of a result but its motion, its forces and what follows
/// from these, the mesh and the two label volumes.
std::string facts_bytes(const RecoveryResult& result);
/// A mesh with its surface, to the last bit.
std::string body_bytes(const BodyMesh& body);
/// Throws Error(input_unreadable), without file name, if the bytes are none.
BodyMesh body_of(std::span<const char> bytes);

/// A result without what can be made again.
struct CompactResult {
    std::string facts;               ///< `facts_bytes`
    BodyMesh body;                   ///< of the reference
    std::vector<Vec3> displacement;  ///< [num_nodes] mm
    std::vector<Vec3> force;         ///< [held nodes] mN, by node
};

/// The whole result from what was kept of it: no mesh is made and nothing is searched. `reference`
/// and `target` are the volumes that it was found from. Throws Error(input_unreadable), without
/// file name, for facts that are none or lists of the wrong length.
RecoveryResult expand_result(const CompactResult& kept, const Segmentation& reference,
                             const Segmentation& target, const Settings& settings);

}  // namespace palpate
