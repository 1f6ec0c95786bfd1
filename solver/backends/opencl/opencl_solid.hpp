// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/backend/solid_device.hpp"
#include "solver/backends/opencl/session.hpp"

namespace palpate {

/// The element loops of one model in the queue of `session`, which outlives them.
std::unique_ptr<SolidDevice> make_opencl_solid(Session& session, SolidTables tables);

}  // namespace palpate
