// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// Tissue from an experiment: `docs/identify.md`.
Application identify_application();

}  // namespace palpate
