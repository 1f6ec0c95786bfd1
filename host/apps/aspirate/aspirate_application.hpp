// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// Profiles of tissue that is sucked into a tube and filmed; docs/aspiration.md.
Application aspirate_application();

}  // namespace palpate
