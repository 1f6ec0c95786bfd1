// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/beside.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

void BesideTable::add(double key, const std::string& column, const std::string& value) {
    if (std::find(columns_.begin(), columns_.end(), column) == columns_.end())
        columns_.push_back(column);
    lines_[key][column] = value;
}

StudyTable BesideTable::table() const {
    StudyTable table;
    table.header = {key_name_};
    table.header.insert(table.header.end(), columns_.begin(), columns_.end());
    for (const auto& [key, values] : lines_) {
        std::vector<std::string> line{fmt::format("{:g}", key)};
        for (const std::string& column : columns_) {
            const auto at = values.find(column);
            line.push_back(at == values.end() ? "–" : at->second);
        }
        table.lines.push_back(line);
    }
    return table;
}

}  // namespace palpate
