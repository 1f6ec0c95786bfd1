// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// A pair of images whose modulus was identified; kPa.
struct StripPoint {
    float e, low, high;    ///< and the 95 % interval
    std::uint32_t number;  ///< in the gallery, from 0
    bool is_weak, is_doubtful;
};

/// The pairs of one region of a patient.
struct PatientStrip {
    std::string patient, region;
    std::size_t pairs = 0;  ///< all that were not excluded
    std::vector<StripPoint> points = {};
};

/// The logarithmic axis of all patients; low 0: there is nothing to show.
struct StripAxis {
    double low = 0, high = 0;  ///< kPa
};
/// From the least to the largest of all estimates, with the middle 98 % of the intervals' ends.
StripAxis strip_axis(const std::vector<PatientStrip>& strips);

/// A row for each patient, all on one axis: a point and its interval for each pair, and the median
/// as a stroke. `link` gives where the card of a pair is. Inline SVG; empty without points.
std::string strips_svg(std::span<const PatientStrip> strips, const StripAxis& axis,
                       const std::function<std::string(std::size_t number)>& link);

/// How many patients have a median in which part of the axis, as inline SVG.
std::string medians_svg(const std::vector<PatientStrip>& strips, const StripAxis& axis,
                        const std::string& region);

}  // namespace palpate
