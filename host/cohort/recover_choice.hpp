// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host/io/option_values.hpp"

namespace palpate {

struct CohortPatient;
struct CohortPlan;

/// The options of recover that hold for a whole cohort.
std::vector<Option> cohort_recover_table();

/// Values of the whole table of recover: those of `recover_toml`, and what a patient says itself.
/// Throws what OptionValues::from_settings throws.
OptionValues recover_values(const std::string& recover_toml, const std::string& align = {});

/// Those that change answers, for the key; defaults included.
std::map<std::string, std::string> options_of_the_key(const OptionValues& values);

}  // namespace palpate
