// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace palpate {

std::string decimals(double value, int digits) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "n/a";
}

std::string decimals_or_dash(double value, int digits) {
    return std::isfinite(value) ? decimals(value, digits) : "–";
}

std::string significant(double value) {
    if (!std::isfinite(value)) return "n/a";
    if (value == 0) return "0";
    const double rounded =
        std::strtod(fmt::format("{:.2e}", value).c_str(), nullptr);  // 9.999 has become 10
    const int exponent = static_cast<int>(std::floor(std::log10(std::abs(rounded))));
    if (exponent < -3 || exponent > 4) return fmt::format("{:.2e}", value);
    return fmt::format("{:.{}f}", rounded, std::clamp(2 - exponent, 0, 5));
}

std::string grouped(std::size_t count) {
    const std::string digits = std::to_string(count);
    std::string text;
    for (std::size_t k = 0; k < digits.size(); ++k) {
        if (k > 0 && (digits.size() - k) % 3 == 0) text += ',';
        text += digits[k];
    }
    return text;
}

}  // namespace palpate
