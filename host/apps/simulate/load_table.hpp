// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/settings_table.hpp"

namespace palpate {

/// Factors of loads at ascending times above 0; between two times they change linearly, from 0 at
/// time 0.
struct LoadTable {
    std::vector<std::string> columns;          ///< names of the factors
    std::vector<double> time_s;                ///< [rows]
    std::vector<std::vector<double>> factors;  ///< [rows, columns]
};

/// Reads [history]: columns as lists, or `file`, a CSV with a header; a first row at time 0 must be
/// zero and is left out. With `longest_step_s` rows are put between. Throws Error(invalid_argument)
/// and for the file Error(input_unreadable), with its line.
LoadTable read_history(const SettingsTable& table, const std::filesystem::path& folder);

/// The same from comma-separated values with the header "time_s,name,..."; lines that are empty or
/// begin with # are left out.
LoadTable parse_load_csv(std::string_view text, const std::string& source_name);

}  // namespace palpate
