// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/recover/pipeline/labelled_state.hpp"
#include "host/apps/recover/pipeline/recover_options.hpp"
#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

/// The reference before it is meshed.
struct ReferenceState {
    LabelledState state;
    double edge_length_mm = 0;  ///< on organ surfaces, for the wanted number of nodes
    RegionSurface surface;
    std::vector<std::vector<Vec3>> fixed_points;  ///< of the fixed organs' surfaces, without caps
};

ReferenceState make_reference(LabelledState state, const RecoverOptions& options,
                              const ProgressSink& progress);

}  // namespace palpate
