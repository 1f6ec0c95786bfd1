// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Numbers in columns that have names, from comma-separated values.
struct NumberTable {
    std::string source;                     ///< name of the file, for complaints
    std::size_t header_line = 0;            ///< of the file, from 1
    std::vector<std::string> columns;       ///< [columns] names, all different
    std::vector<std::vector<double>> rows;  ///< [rows, columns]
    std::vector<std::size_t> lines;         ///< [rows] of the file, from 1

    std::optional<std::size_t> find(std::string_view column) const;
    /// The values of a column [rows]. Throws Error(input_unreadable) with the names that there are.
    std::vector<double> values(std::string_view column) const;
    /// Throws Error(input_unreadable) "file, line n: why".
    [[noreturn]] void refuse_row(std::size_t row, const std::string& why) const;
};

/// A header and rows of finite numbers with a decimal point; lines that are empty or begin with #
/// are left out. Throws Error(input_unreadable) "file, line n: what is wrong".
NumberTable parse_number_table(std::string_view text, const std::string& source_name,
                               std::size_t most_rows = 100000);

/// The same from a file of at most 160 bytes a row.
NumberTable read_number_table(const std::filesystem::path& path, std::size_t most_rows = 100000);

}  // namespace palpate
