// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/aspirate/model/aspiration_settings.hpp"
#include "host/apps/aspirate/profile_axis.hpp"

namespace palpate {

/// Where the axis of the tube is in a film: at the column that is told, or where the outlines of
/// the first ten frames with tissue on both sides are most alike.
class AxisFinder {
public:
    explicit AxisFinder(const AspirationInstrument& instrument) : instrument_(instrument) {}

    /// The next frame's; those in which tissue is not seen yet say nothing.
    void add(const Outline& outline);
    /// Whether the column will not change any more.
    bool is_settled() const;
    /// In what `crop_px` keeps, from 0; as frames so far tell it, the middle where they do not.
    double column() const;
    /// How alike both sides are about a column, in the first ten frames with tissue.
    ProfileAxis sides_about(double column) const;
    /// Whether it is told, or some frame has told it.
    bool is_known() const { return instrument_.axis_column_px || !seen_.empty(); }

private:
    double radius_mm() const { return 0.5 * instrument_.hole_diameter_mm; }
    double mm_per_column() const { return instrument_.pixel_r_um / 1000; }

    AspirationInstrument instrument_;
    double middle_ = 0, found_r_mm_ = 0;
    ProfileSeries seen_;  ///< r from the middle column
};

}  // namespace palpate
