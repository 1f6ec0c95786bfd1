// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/application.hpp"

// What is said of applications elsewhere, made from their tables of options.
namespace palpate {

/// For programs: {"applications": [{"name", "summary", "options": [{"name", "kind", ...}]}]}, with
/// the default and, where there are any, unit, limits, choices and numbers of values of each
/// option.
std::string applications_json(const std::vector<Application>& all);

/// For people: a page of the documentation with a heading and a table for each.
std::string applications_markdown(const std::vector<Application>& all);

/// A descriptor of its command for Boutiques (https://boutiques.github.io, schema 0.5).
std::string boutiques_json(const Application& application);

}  // namespace palpate
