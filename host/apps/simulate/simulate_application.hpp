// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// Forces and displacements in, the deformation of a body of known tissue out.
Application simulate_application();

}  // namespace palpate
