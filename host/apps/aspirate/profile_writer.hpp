// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/aspirate/model/aspiration_settings.hpp"

namespace palpate {

/// From so many frames the axis is found where it is not told.
inline constexpr std::size_t frames_for_axis = 10;
inline constexpr Index least_axis_pairs = 5;  ///< of columns that are compared

/// The axis of an outline that is alike on both sides.
struct OutlineAxis {
    double column = 0;     ///< pixels
    double asymmetry = 0;  ///< root mean square of half of the differences of both sides, pixels
    Index num_pairs = 0;   ///< columns that were compared
};

/// The column about which the points without a flag are most alike: the least sum of
/// (y(x + d) - y(x - d))^2 over all outlines, to a twentieth of a pixel. Without pairs: the middle.
OutlineAxis find_axis(const std::vector<Outline>& outlines);

/// Turns outlines into rows "time_s, r_mm, z_mm, sd_mm, flag" of profiles, z above the lower face
/// of the rim. The flag is a number: 0 ok, 1 guessed, 2 hidden (then z is the middle of what the
/// rim hides), 3 lost. Where the axis is not given the outlines of the first ten frames tell it,
/// and their rows come then.
class ProfileWriter {
public:
    ProfileWriter(const AspirationInstrument& instrument,
                  std::function<void(const std::string&)> write);

    void add(const Outline& outline, double time_s);
    /// Writes what still waits.
    void finish();
    /// Empty until it is known.
    const std::optional<OutlineAxis>& axis() const { return axis_; }

private:
    void settle_axis();
    void write_rows(const Outline& outline, double time_s);

    AspirationInstrument instrument_;
    std::function<void(const std::string&)> write_;
    std::optional<OutlineAxis> axis_;
    std::vector<Outline> waiting_;
    std::vector<double> waiting_s_;
    std::string text_;
};

}  // namespace palpate
