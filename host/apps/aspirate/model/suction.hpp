// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/io/settings_table.hpp"

namespace palpate {

inline constexpr double kpa_per_mbar = 0.1;
inline constexpr double most_suction_mbar = 1000;  ///< of any reading

/// The suction over time: straight lines between readings, the first before and the last after
/// them.
struct Suction {
    std::vector<double> time_s;  ///< [readings] ascending
    std::vector<double> kpa;     ///< [readings] 0 or more: below the pressure outside

    double at(double time_s) const;
    double peak_kpa() const;
    /// When it begins to rise: the last reading of at most 0.5 % of the peak before the first one
    /// above.
    double begin_s() const;
    double end_s() const { return time_s.back(); }
};

/// Columns time_s and suction_mbar or suction_kpa of a table. Throws Error(input_unreadable) for
/// what is no such table, Error(input_unusable) where times do not ascend, suction is below 0 or
/// above 1000 mbar, there is none, or there is some from the first reading on.
Suction read_suction(const std::filesystem::path& path);
/// The same of lists in [pressure]; empty if there are none.
std::optional<Suction> suction_of(const SettingsTable& table);

/// Times at which a body under this suction is solved, and its share of the peak then.
struct SuctionSteps {
    std::vector<double> time_s;  ///< from the begin of suction, above 0
    std::vector<double> share;
};

/// About `count` steps from the begin of suction to `end_s`: where the suction has a kink (lines
/// that leave it by less than 0.6 % of the peak are straight), short ones behind each kink. Steps
/// come in pairs of the same length.
SuctionSteps suction_steps(const Suction& suction, double end_s, int count);

}  // namespace palpate
