// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>

namespace palpate {

/// A number of settings: given, known with an error, or not known.
struct SettingNumber {
    double value = 0;
    std::optional<double> sd = {};  ///< known with an error
    bool is_unknown = false;

    /// As a model file says it, times `factor` (0.5: a radius of a diameter).
    std::string text(double factor = 1) const {
        if (is_unknown) return "\"unknown\"";
        if (!sd) return fmt::format("{:.10g}", value * factor);
        return fmt::format("{{value = {:.10g}, sd = {:.6g}}}", value * factor, *sd * factor);
    }
    /// The same of one that data are not to change.
    std::string held_text(double factor = 1) const {
        std::string told = text(factor);
        if (sd) told.insert(told.size() - 1, ", held = true");
        return told;
    }
    /// Of its size: {value = 1, sd = sd / value}; "1" if it is given.
    std::string scale_text() const {
        if (!sd) return "1";
        return fmt::format("{{value = 1, sd = {:.6g}}}", *sd / value);
    }
};

}  // namespace palpate
