// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "host/io/settings_table.hpp"
#include "solver/base/types.hpp"

// Values that several tables of a model file hold.
namespace palpate {

inline constexpr NumberRange positive{0, any_number.high, true};
inline constexpr NumberRange not_negative{0, any_number.high};

/// [x, y, z], or [x, y] with z = 0.
std::optional<Vec3> vector_of(const SettingsTable& table, std::string_view key);
Vec3 needed_vector(const SettingsTable& table, std::string_view key);
double needed_number(const SettingsTable& table, std::string_view key, NumberRange range);

}  // namespace palpate
