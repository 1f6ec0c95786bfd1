// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/profile_writer.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "host/apps/aspirate/profile_series.hpp"

namespace palpate {
namespace {

constexpr double coarse_step = 0.5, fine_step = 0.05;  // pixels

/// The row between columns; empty beside points without a flag.
std::optional<double> row_at(const Outline& outline, double column) {
    const auto left = Index(std::floor(column));
    if (left < 0 || left + 1 >= Index(outline.size())) return std::nullopt;
    const OutlinePoint &a = outline[std::size_t(left)], &b = outline[std::size_t(left) + 1];
    if (a.flag != PointFlag::ok || b.flag != PointFlag::ok) return std::nullopt;
    return a.row + (column - left) * (b.row - a.row);
}

OutlineAxis about(const std::vector<Outline>& outlines, double column) {
    OutlineAxis axis{column};
    double squares = 0;
    for (const Outline& outline : outlines)
        for (double d = 1; d < double(outline.size()) / 2; d += 2) {
            const auto left = row_at(outline, column - d), right = row_at(outline, column + d);
            if (!left || !right) continue;
            squares += 0.25 * (*left - *right) * (*left - *right);
            ++axis.num_pairs;
        }
    axis.asymmetry = axis.num_pairs ? std::sqrt(squares / axis.num_pairs) : 0;
    return axis;
}

}  // namespace

OutlineAxis find_axis(const std::vector<Outline>& outlines) {
    const double middle = outlines.empty() ? 0 : 0.5 * double(outlines[0].size() - 1);
    const Index enough = std::max(least_axis_pairs, about(outlines, middle).num_pairs / 2);
    OutlineAxis best = about(outlines, middle);
    const auto search = [&](double from, double to, double step) {
        for (double column = from; column <= to; column += step) {
            const OutlineAxis one = about(outlines, column);
            if (one.num_pairs >= enough &&
                (best.num_pairs < enough || one.asymmetry < best.asymmetry))
                best = one;
        }
    };
    search(0.6 * middle, 1.4 * middle, coarse_step);
    search(best.column - coarse_step, best.column + coarse_step, fine_step);
    return best;
}

ProfileWriter::ProfileWriter(const AspirationInstrument& instrument,
                             std::function<void(const std::string&)> write)
    : instrument_(instrument), write_(std::move(write)) {
    write_("time_s,r_mm,z_mm,sd_mm,flag\n");
}

void ProfileWriter::add(const Outline& outline, double time_s) {
    if (axis_) return write_rows(outline, time_s);
    waiting_.push_back(outline);
    waiting_s_.push_back(time_s);
    if (instrument_.axis_column_px || waiting_.size() == frames_for_axis) settle_axis();
}

void ProfileWriter::settle_axis() {
    axis_ = instrument_.axis_column_px ? about(waiting_, *instrument_.axis_column_px)
                                       : find_axis(waiting_);
    for (std::size_t k = 0; k < waiting_.size(); ++k) write_rows(waiting_[k], waiting_s_[k]);
    waiting_.clear();
}

void ProfileWriter::finish() {
    if (!axis_) settle_axis();
}

void ProfileWriter::write_rows(const Outline& outline, double time_s) {
    const FrameProfile profile = profile_of(outline, time_s, axis_->column, instrument_);
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
