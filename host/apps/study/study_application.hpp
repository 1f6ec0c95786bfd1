// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// Many phantoms with known answers, recovered, and the errors judged.
Application study_application();

}  // namespace palpate
