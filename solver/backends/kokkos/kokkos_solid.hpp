// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/backend/solid_device.hpp"

namespace palpate {

/// One parallel loop over the elements of each law, then one over nodes or blocks that gathers
/// their results. `Real`: float or double.
template <typename Real>
std::unique_ptr<SolidDevice> make_kokkos_solid(SolidTables tables);

}  // namespace palpate
