// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/setting_values.hpp"

namespace palpate {

std::optional<Vec3> vector_of(const SettingsTable& table, std::string_view key) {
    const auto values = table.numbers(key, 2, 3);
    if (!values) return std::nullopt;
    return Vec3((*values)[0], (*values)[1], values->size() == 3 ? (*values)[2] : 0);
}

Vec3 needed_vector(const SettingsTable& table, std::string_view key) {
    const auto value = vector_of(table, key);
    if (!value) table.missing(key, "[x, y, z], in a plane [x, y]");
    return *value;
}

double needed_number(const SettingsTable& table, std::string_view key, NumberRange range) {
    const auto value = table.number(key, range);
    if (!value) table.missing(key, range.low == 0 ? "a number greater than 0" : "a number");
    return *value;
}

}  // namespace palpate
