// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// The text with '?' for every control character, so that a terminal cannot be misled.
std::string harmless(std::string text);

/// A number as comma-separated values hold it; empty if it is not finite.
std::string csv_number(double value);
/// A text in quotes, harmless.
std::string csv_text(const std::string& text);

/// Rows of text in aligned columns under a header and a rule.
class TextTable {
public:
    /// `to_the_right` [columns]: which columns end alike, as numbers should.
    TextTable(std::vector<std::string> header, std::vector<bool> to_the_right);

    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
    /// Ends with a newline.
    std::string text() const;

private:
    std::string line(const std::vector<std::string>& row,
                     const std::vector<std::size_t>& widths) const;

    std::vector<std::vector<std::string>> rows_;
    std::vector<bool> to_the_right_;
};

}  // namespace palpate
