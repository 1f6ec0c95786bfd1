// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/backend/solid_device.hpp"

namespace palpate {

/// Plain loops over the elements on one host thread in fp64.
std::unique_ptr<SolidDevice> make_reference_solid(SolidTables tables);

}  // namespace palpate
