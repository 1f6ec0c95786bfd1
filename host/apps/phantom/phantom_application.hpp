// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// Input whose answer is known.
Application phantom_application();

}  // namespace palpate
