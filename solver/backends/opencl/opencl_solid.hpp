// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/backend/solid_device.hpp"
#include "solver/backends/opencl/session.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// The element loops of `model` in the queue of `session`, which outlives them.
std::unique_ptr<SolidDevice> make_opencl_solid(Session& session, const SolidModel& model);

}  // namespace palpate
