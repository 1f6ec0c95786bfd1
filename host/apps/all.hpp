// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/application.hpp"

namespace palpate {

/// Every application that has a table of options.
const std::vector<Application>& applications();

/// Throws Error(invalid_argument) with the names that there are.
const Application& application_named(const std::string& name);

}  // namespace palpate
