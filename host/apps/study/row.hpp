// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// One row of study.csv: named values in order. A number is kept as the text that the file holds,
/// so that a row which was read again is equal to the one that was written.
class Row {
public:
    void set(const std::string& name, const std::string& text);
    void set(const std::string& name, double value, int decimals);  ///< empty if not finite
    void set_flag(const std::string& name, bool value);             ///< "yes" or "no"

    bool has(const std::string& name) const;
    const std::string& text(const std::string& name) const;  ///< empty if there is none
    double number(const std::string& name) const;            ///< NaN if there is none
    bool flag(const std::string& name) const;
    const std::vector<std::pair<std::string, std::string>>& values() const { return values_; }

private:
    std::vector<std::pair<std::string, std::string>> values_;
};

/// A header line with `columns` and one line per row; missing values are empty. Values with commas,
/// quotes or line ends are quoted (RFC 4180).
std::string to_csv(const std::vector<std::string>& columns, const std::vector<Row>& rows);

/// The rows of such a text. Throws Error(input_unreadable) naming `source` and the line if one has
/// more or fewer values than the header.
std::vector<Row> parse_csv(const std::string& text, const std::string& source);

}  // namespace palpate
