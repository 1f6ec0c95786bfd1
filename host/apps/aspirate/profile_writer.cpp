// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/profile_writer.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "host/apps/aspirate/profile_series.hpp"

namespace palpate {
namespace {

/// Frames at the begin without tissue that rows wait for; the middle is the axis then.
constexpr std::size_t most_waiting = 2000;

}  // namespace

ProfileWriter::ProfileWriter(const AspirationInstrument& instrument,
                             std::function<void(const std::string&)> write)
    : instrument_(instrument), write_(std::move(write)), finder_(instrument) {
    write_("time_s,r_mm,z_mm,sd_mm,flag\n");
}

void ProfileWriter::add(const Outline& outline, double time_s) {
    finder_.add(outline);
    if (axis_column_) return write_rows(outline, time_s);
    waiting_.push_back(outline);
    waiting_s_.push_back(time_s);
    if (finder_.is_settled() || waiting_.size() == most_waiting) finish();
}

void ProfileWriter::finish() {
    if (axis_column_) return;
    axis_column_ = finder_.column();
    is_known_ = finder_.is_known();
    for (std::size_t k = 0; k < waiting_.size(); ++k) write_rows(waiting_[k], waiting_s_[k]);
    waiting_.clear();
}

FilmAxis ProfileWriter::axis() const {
    const double column = axis_column_.value_or(finder_.column());
    return {.column = column,
            .asymmetry_mm = finder_.sides_about(column).asymmetry_mm,
            .is_known = is_known_};
}

void ProfileWriter::write_rows(const Outline& outline, double time_s) {
    const FrameProfile profile = profile_of(outline, time_s, *axis_column_, instrument_);
    const std::string time = fmt::format("{:.4f},", profile.time_s);
    text_.clear();
    for (const ProfilePoint& point : profile.points) {
        text_ += time;
        fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{:.4f},{:.5f},{:.5f},{}\n"),
                       point.r_mm, point.z_mm, point.sd_mm, int(point.flag));
    }
    write_(text_);
}

}  // namespace palpate
