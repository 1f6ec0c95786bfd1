// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/study/tables.hpp"

namespace palpate {

/// A table put together value by value: one line per key (a number, ascending), one column per
/// source in the order in which they come; "–" where nothing was added.
class BesideTable {
public:
    explicit BesideTable(std::string key_name) : key_name_(std::move(key_name)) {}
    void add(double key, const std::string& column, const std::string& value);
    StudyTable table() const;

private:
    std::string key_name_;
    std::vector<std::string> columns_;
    std::map<double, std::map<std::string, std::string>> lines_;
};

}  // namespace palpate
