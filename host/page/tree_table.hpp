// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/page/result_tree.hpp"

namespace palpate {

/// A list's parts as lines of text cells, with what a writer of tables must know of the columns.
struct TreeTable {
    struct Column {
        std::string title, unit;
        bool is_number = true;
        bool is_verdict = false;
    };
    std::vector<Column> columns;
    std::vector<std::vector<std::string>> lines;  ///< [parts][columns]
    std::vector<const ResultTree*> parts;         ///< of the lines

    /// The cells as a table for a terminal; control characters are replaced.
    std::string text() const;
    /// The cells as an HTML table, escaped, verdicts as coloured labels; what `mark_html` says of a
    /// part stands before its first cell.
    std::string html(const std::function<std::string(const ResultTree&)>& mark_html = {}) const;
    /// The column with this title. Throws Error(internal) if there is none.
    std::size_t column(const std::string& title) const;
};

/// Columns are the figures `names` of the list's parts, in this order, an estimate with its 95 %
/// interval and verdict where any part has one; a figure that no part has makes no column, and a
/// part that has none but the first makes no line. `dash` stands for what does not exist.
TreeTable table_of(const ResultTree& list, const std::vector<std::string>& names,
                   const char* dash = "–");
/// The same with every figure that has a title, in the order in which they occur.
TreeTable table_of(const ResultTree& list);

}  // namespace palpate
