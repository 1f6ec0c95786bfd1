// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>

#include "host/apps/recover/pipeline/segmentation.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// A ball of tissue beside a hollow one that fills by 3 mm and moves it by 2: reference and target,
/// 24 voxels of 3 mm along each axis. No body does quite that; a recovery of it uses all that other
/// recoveries use.
std::array<Segmentation, 2> tiny_phantom();

/// Recovers it with the options of a cohort, from no file of it but the plan: on the same back end
/// and device (by multigrid, unless they name a solver), with the same mesher and law. Throws what
/// recovering throws: where it does, no case can be recovered either. Not converging is no error.
/// Takes some seconds.
void recover_tiny_phantom(const std::filesystem::path& cohort, const ProgressSink& progress);

}  // namespace palpate
