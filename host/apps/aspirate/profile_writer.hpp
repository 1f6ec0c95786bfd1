// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/aspirate/axis_finder.hpp"

namespace palpate {

/// The axis of a film that was followed.
struct FilmAxis {
    double column = 0;        ///< in what `crop_px` keeps
    double asymmetry_mm = 0;  ///< of both sides about it, root mean square of half the differences
    bool is_known = false;    ///< told, or seen in a frame; else the middle
};

/// Turns outlines into rows "time_s, r_mm, z_mm, sd_mm, flag" of profiles, z above the lower face
/// of the rim. The flag is a number: 0 ok, 1 guessed, 2 hidden (then z is the middle of what the
/// rim hides), 3 lost. Where the axis is not given the outlines of the first ten frames with tissue
/// tell it, and rows come from then on, with those of the frames before; after 2,000 frames without
/// it is the middle column.
class ProfileWriter {
public:
    ProfileWriter(const AspirationInstrument& instrument,
                  std::function<void(const std::string&)> write);

    void add(const Outline& outline, double time_s);
    /// Writes what still waits.
    void finish();
    FilmAxis axis() const;

private:
    void write_rows(const Outline& outline, double time_s);

    AspirationInstrument instrument_;
    std::function<void(const std::string&)> write_;
    AxisFinder finder_;
    std::optional<double> axis_column_;  ///< that rows are written with
    bool is_known_ = false;              ///< that column, when the first row was written
    std::vector<Outline> waiting_;
    std::vector<double> waiting_s_;
    std::string text_;
};

}  // namespace palpate
