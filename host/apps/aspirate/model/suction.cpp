// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/model/suction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host/io/number_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double least_peak_mbar = 0.5;
constexpr double begin_part = 0.005, most_at_first = 0.05;  // of the peak
constexpr double straight_part = 0.006;
constexpr double least_reading_mbar = -0.5;  // a sensor's zero may be off by so much
// Steps come in pairs of the same length, so that a coarser model may take two together:
constexpr double first_part = 0.125;     // of the longest pair, behind a kink
constexpr double most_change = 1.0 / 6;  // of the share, in a pair: between steps it is a line
constexpr int least_between_kinks = 2;   // pairs: a curve leaves its chord by a sixteenth as much
constexpr double sharp_turn = 0.2;       // of the share in a longest pair: milder ones get longer
constexpr double growth = 2.25;

[[noreturn]] void refuse(const std::string& source, const std::string& why) {
    throw Error(ErrorCode::input_unusable, source + ": " + why);
}

void check(const Suction& suction, const std::string& source) {
    const std::size_t count = suction.time_s.size();
    if (count < 2) refuse(source, "a history of suction needs two readings at least");
    for (std::size_t k = 0; k < count; ++k) {
        const double mbar = suction.kpa[k] / kpa_per_mbar;
        if (k > 0 && !(suction.time_s[k] > suction.time_s[k - 1]))
            refuse(source, fmt::format("times must ascend; there is {:g} s after {:g} s",
                                       suction.time_s[k], suction.time_s[k - 1]));
        if (mbar < least_reading_mbar || mbar > most_suction_mbar)
            refuse(source, fmt::format("the suction is {:g} mbar ({:g} kPa) at {:g} s; allowed: 0 "
                                       "to {:g} mbar, positive where it sucks; check its unit, too",
                                       mbar, suction.kpa[k], suction.time_s[k], most_suction_mbar));
    }
    const double peak_kpa = suction.peak_kpa();
    if (peak_kpa < least_peak_mbar * kpa_per_mbar)
        refuse(source, "there is no suction; give readings of a cycle");
    if (suction.kpa.front() > most_at_first * peak_kpa)
        refuse(source,
               fmt::format("the suction is {:g} mbar already at the first reading; begin before "
                           "the tissue is sucked",
                           suction.kpa.front() / kpa_per_mbar));
}

Suction checked(std::vector<double> time_s, std::vector<double> kpa, const std::string& source) {
    Suction suction{std::move(time_s), std::move(kpa)};
    check(suction, source);
    for (double& value : suction.kpa) value = std::max(0.0, value);
    return suction;
}

/// Kinks between readings `from` and `to`, by the farthest from the chord (Ramer, Douglas,
/// Peucker).
void add_kinks(const Suction& suction, std::size_t from, std::size_t to, double most,
               std::vector<double>& kinks) {
    double farthest = most;
    std::size_t at = from;
    for (std::size_t k = from + 1; k < to; ++k) {
        const double part = (suction.time_s[k] - suction.time_s[from]) /
                            (suction.time_s[to] - suction.time_s[from]);
        const double away = std::abs(
            suction.kpa[k] - (suction.kpa[from] + part * (suction.kpa[to] - suction.kpa[from])));
        if (away <= farthest) continue;
        farthest = away;
        at = k;
    }
    if (at == from) return;
    add_kinks(suction, from, at, most, kinks);
    kinks.push_back(suction.time_s[at]);
    add_kinks(suction, at, to, most, kinks);
}

}  // namespace

double Suction::at(double when_s) const {
    const auto after = std::lower_bound(time_s.begin(), time_s.end(), when_s);
    if (after == time_s.begin()) return kpa.front();
    if (after == time_s.end()) return kpa.back();
    const auto k = std::size_t(after - time_s.begin());
    const double part = (when_s - time_s[k - 1]) / (time_s[k] - time_s[k - 1]);
    return kpa[k - 1] + part * (kpa[k] - kpa[k - 1]);
}

double Suction::peak_kpa() const { return *std::max_element(kpa.begin(), kpa.end()); }

double Suction::begin_s() const {
    const double least = begin_part * peak_kpa();
    std::size_t k = 0;
    while (k < kpa.size() && kpa[k] <= least) ++k;
    return time_s[k > 0 ? k - 1 : 0];
}

Suction read_suction(const std::filesystem::path& path) {
    const NumberTable table = read_number_table(path);
    const bool is_mbar = table.find("suction_mbar").has_value();
    if (!is_mbar && !table.find("suction_kpa"))
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{}: no column 'suction_mbar' or 'suction_kpa'; give one of both",
                                table.source));
    std::vector<double> kpa = table.values(is_mbar ? "suction_mbar" : "suction_kpa");
    if (is_mbar)
        for (double& value : kpa) value *= kpa_per_mbar;
    return checked(table.values("time_s"), std::move(kpa), table.source);
}

std::optional<Suction> suction_of(const SettingsTable& table) {
    constexpr std::size_t most = 100000;
    auto times = table.numbers("time_s", 2, most);
    const char* key = table.has("suction_mbar") ? "suction_mbar" : "suction_kpa";
    if (!times) {
        if (table.has(key)) table.missing("time_s", "the times of the readings");
        return std::nullopt;
    }
    auto kpa = table.numbers(key, times->size(), times->size());
    if (!kpa) table.missing("suction_mbar", "a reading for each time");
    if (table.has("suction_mbar"))
        for (double& value : *kpa) value *= kpa_per_mbar;
    return checked(std::move(*times), std::move(*kpa), "[pressure]");
}

SuctionSteps suction_steps(const Suction& suction, double end_s, int count) {
    const double begin_s = suction.begin_s();
    std::vector<double> kinks{begin_s}, found;
    add_kinks(suction, 0, suction.time_s.size() - 1, straight_part * suction.peak_kpa(), found);
    const double longest_s = 2 * (end_s - begin_s) / count;  // of a pair
    for (const double kink : found)
        if (kink > kinks.back() + 0.1 * longest_s && kink < end_s - 0.1 * longest_s)
            kinks.push_back(kink);
    kinks.push_back(end_s);
    const auto slope_behind = [&](std::size_t kink) {  // of the share, 1/s
        return (suction.at(kinks[kink + 1]) - suction.at(kinks[kink])) /
               (suction.peak_kpa() * (kinks[kink + 1] - kinks[kink]));
    };
    // how much the share turns away from a straight line in a longest pair
    const auto first_part_behind = [&](std::size_t kink) {
        const double turn =
            std::abs(slope_behind(kink) - (kink > 0 ? slope_behind(kink - 1) : 0.0)) * longest_s;
        return turn > 0 ? std::clamp(first_part * sharp_turn / turn, first_part, 1.0) : 1.0;
    };
    SuctionSteps steps;
    for (std::size_t k = 1; k < kinks.size(); ++k) {
        const double span_s = kinks[k] - kinks[k - 1];
        std::vector<double> ends{0};
        const double change = std::abs(slope_behind(k - 1)) * span_s;
        const double least = std::max<double>(least_between_kinks, change / most_change);
        const double longest_here_s = std::min(longest_s, span_s / least);
        for (double step = std::min(longest_here_s, longest_s * first_part_behind(k - 1));
             ends.back() < span_s * (1 - 1e-9); step = std::min(growth * step, longest_here_s))
            ends.push_back(ends.back() + step);
        for (std::size_t n = 1; n < ends.size(); ++n) {
            // stretched to end at the next kink
            for (const double end : {0.5 * (ends[n - 1] + ends[n]), ends[n]}) {
                const double at = kinks[k - 1] + end * span_s / ends.back();
                steps.time_s.push_back(at - begin_s);
                steps.share.push_back(suction.at(at) / suction.peak_kpa());
            }
        }
    }
    return steps;
}

}  // namespace palpate
