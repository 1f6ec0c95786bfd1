// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// What is wrong with a table, and where.
struct TableFault {
    std::size_t line = 0;  ///< of the file, from 1; 0: of the table as a whole
    std::string column;    ///< empty: of the whole row
    std::string sentence;
    std::size_t num_values = 0;  ///< of a row that has too many or too few; else 0
};

/// A table whose cells are text and stay what they are: "007", "NA", "nan".
struct DelimitedText {
    std::size_t header_line = 0;  ///< of the file, from 1
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;  ///< [rows, columns]
    std::vector<std::size_t> lines;              ///< [rows] of the file, from 1
    std::vector<TableFault> faults;              ///< rows with one are not in `rows`

    std::optional<std::size_t> find(std::string_view column) const;
};

struct DelimitedFormat {
    char separator = ',';
    bool has_comments = false;    ///< lines that begin with #, and blanks round cells, are left out
    bool takes_any_text = false;  ///< line ends and control characters in cells are no fault
};

/// A row as it stands: no cell of it is checked.
struct RawRow {
    std::size_t line = 0;
    std::vector<std::string> cells;
    std::string complaint;  ///< about its quotes; empty: none
};

/// Reads rows as `parse_delimited` does, one after the other, the header like any other.
void for_each_row(std::string_view text, const DelimitedFormat& format,
                  const std::function<void(RawRow& row)>& take);

/// The same as `parse_delimited`, for tables too long to be held: `take` gets each row without
/// fault, and `rows` and `lines` stay empty. It may add faults to `table` meanwhile.
void read_delimited(std::string_view text, const DelimitedFormat& format, DelimitedText& table,
                    const std::function<void(RawRow& row)>& take);

/// Reads a header and rows as RFC 4180 has them, for any separator: cells may stand in double
/// quotes, in which a quote is doubled and lines may end. Empty lines are left out, a byte order
/// mark is allowed. Never throws: faults are listed, all of them.
DelimitedText parse_delimited(std::string_view text, const DelimitedFormat& format);

/// One line with its end; cells that need quotes get them.
std::string delimited_line(const std::vector<std::string>& cells, char separator);

}  // namespace palpate
