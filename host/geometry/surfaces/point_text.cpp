// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/point_text.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// The three numbers of a line, or nothing if it is anything else.
std::optional<Vec3> numbers_of(std::string line) {
    for (char& c : line) {
        if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
    }
    Vec3 point;
    const char *at = line.data(), *end = at + line.size();
    const auto skip_blanks = [&] { at = std::find_if(at, end, [](char c) { return c != ' '; }); };
    for (double& number : point) {
        skip_blanks();
        if (at != end && *at == '+') ++at;
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc()) return std::nullopt;
        at = next;
    }
    skip_blanks();
    return at == end ? std::optional(point) : std::nullopt;
}

}  // namespace

std::vector<Vec3> points_of_text(std::istream& text) {
    std::vector<Vec3> points;
    bool has_header = false;
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
        const std::size_t first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos || line[first] == '#') continue;
        if (const auto point = numbers_of(line)) {
            points.push_back(*point);
        } else if (points.empty() && !has_header) {
            has_header = true;
        } else {
            throw Error(ErrorCode::input_unreadable,
                        "line " + std::to_string(number) + " is not three numbers x, y, z");
        }
    }
    return points;
}

}  // namespace palpate
