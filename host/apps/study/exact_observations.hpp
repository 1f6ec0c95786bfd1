// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/phantom/pelvis.hpp"
#include "host/apps/recover/inverse/map_estimate.hpp"
#include "host/apps/recover/observations/surface_observations.hpp"
#include "host/apps/recover/pipeline/mechanics.hpp"

namespace palpate {

/// The exact surfaces of a phantom before and after its deformation, without voxels, seen from
/// every surface node of `recovery`, which may have another mesh than the phantom. `noise_mm` is
/// what a search assumes at first.
SurfaceObservations exact_observations(const RecoveryModel& recovery, const PelvisPhantom& phantom,
                                       double noise_mm);

/// A search that takes such surfaces for as exact as they are.
MapOptions exact_search(double noise_mm);
/// For the response model of such a search: what it may leave out, mm.
ResponseOptions exact_response(double tolerance_mm);

}  // namespace palpate
