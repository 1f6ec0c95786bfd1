// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// The smallest inverse problem: two springs in series, pulled by a known force, whose stiffness
/// follows from how far they move. docs/new_application.md walks through it.
Application springs_application();

}  // namespace palpate
