// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/apps/recover/pipeline/prepared_reference.hpp"

namespace palpate {

/// What a prepared reference was made from, as far as it changes the mesh or the reduced model.
struct ReferenceFingerprint {
    std::string version;        ///< of palpate
    std::string settings_toml;  ///< without what only the search reads
    ImageGrid grid;
    std::uint64_t voxels_hash = 0;  ///< of the region numbers
};

ReferenceFingerprint fingerprint_of(const LabelledState& reference, const Settings& settings);

/// A symmetric sparse matrix as a list of its entries.
struct SparseEntries {
    Index size = 0;
    std::vector<Index> rows, columns;
    std::vector<double> values;
};

/// The costly part of a prepared reference, which no target changes. The rest follows from it and
/// the reference's label volume in about a second.
struct SavedReference {
    std::string name;  ///< of the file, for messages
    ReferenceFingerprint made_from;
    std::vector<std::vector<Vec3>> fixed_points;  ///< as in ReferenceState
    BodyMesh mesh;
    MesherSummary mesher;
    SparseEntries wall_precision;  ///< [driven nodes, driven nodes] per mm^2, of one component
    ResponseModel::Parts response;
    std::vector<Unknown> unknowns;
    CondensationSummary condensation;  ///< without `linear`
};

SavedReference saved_form(const PreparedReference& prepared, const Settings& settings);

/// Throws Error(input_unusable) naming the first thing that differs between what `saved` was made
/// from and this reference with these settings, Error(input_unreadable) if `saved` itself is
/// contradictory.
void check_same_reference(const SavedReference& saved, const LabelledState& reference,
                          const Settings& settings);

/// The reference before meshing, without the surface that only the mesher needs.
ReferenceState reference_state(const SavedReference& saved, LabelledState state);

/// The prepared reference, the same to the last bit as the one that was saved. `saved` must have
/// passed `check_same_reference`. Throws Error(input_unreadable) if it is contradictory.
PreparedReference restore(SavedReference saved, ReferenceState reference,
                          const RecoverOptions& options);

}  // namespace palpate
