// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/axis_finder.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

void AxisFinder::add(const Outline& outline) {
    if (seen_.size() >= frames_for_axis) return;
    middle_ = 0.5 * double(outline.size() - 1);
    const auto num_sure =
        std::count_if(outline.begin(), outline.end(),
                      [](const OutlinePoint& point) { return point.flag == PointFlag::ok; });
    if (num_sure < 2 * least_axis_pairs) return;
    FrameProfile profile = whole_profile_of(outline, 0, middle_, instrument_);
    if (find_axis({profile}, radius_mm()).num_pairs < least_axis_pairs) return;
    seen_.push_back(std::move(profile));
    found_r_mm_ = find_axis(seen_, radius_mm()).r_mm;
}

bool AxisFinder::is_settled() const {
    return instrument_.axis_column_px || seen_.size() >= frames_for_axis;
}

double AxisFinder::column() const {
    return instrument_.axis_column_px.value_or(middle_ + found_r_mm_ / mm_per_column());
}

ProfileAxis AxisFinder::sides_about(double column) const {
    return axis_at(seen_, (column - middle_) * mm_per_column(), radius_mm());
}

}  // namespace palpate
