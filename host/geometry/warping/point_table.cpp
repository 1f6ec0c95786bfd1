// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/point_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Cells = std::vector<std::string>;

constexpr const char* inside_name = "inside";

std::string trimmed(const std::string& text) {
    const char* blank = " \t\r";
    const auto first = text.find_first_not_of(blank);
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// Cells of one line; commas in double quotes do not separate, and the quotes stay.
Cells cells_of(const std::string& line) {
    Cells cells(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted) {
            cells.emplace_back();
        } else {
            cells.back() += c;
        }
    }
    for (std::string& cell : cells) cell = trimmed(cell);
    return cells;
}

std::optional<double> number_in(const std::string& cell) {
    double value = 0;
    const char* begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
        return {};
    return value;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::optional<std::size_t> column_named(const Cells& header, const std::string& name) {
    for (std::size_t c = 0; c < header.size(); ++c) {
        const std::string here = lower(header[c]);
        if (here == name || here == name + "_mm") return c;
    }
    return {};
}

bool is_header(const Cells& cells) {
    const auto is_number = [](const std::string& cell) { return number_in(cell).has_value(); };
    return std::none_of(cells.begin(), cells.begin() + std::min<std::size_t>(3, cells.size()),
                        is_number);
}

void take_header(const Cells& cells, PointTable& table) {
    table.header = cells;
    const std::array<const char*, 3> names{"x", "y", "z"};
    for (int a = 0; a < 3; ++a) {
        const auto column = column_named(cells, names[a]);
        if (!column) {
            throw Error(
                ErrorCode::input_unusable,
                fmt::format("its header names no column {}; x, y and z are needed", names[a]));
        }
        table.columns[a] = *column;
    }
}

Vec3 flipped(const Vec3& point, PointAxes axes) {
    return axes == PointAxes::ras ? Vec3(-point.x(), -point.y(), point.z()) : point;
}

Vec3 point_in(const Cells& cells, const PointTable& table, std::size_t line) {
    Vec3 point;
    for (int a = 0; a < 3; ++a) {
        const std::size_t column = table.columns[a];
        const auto value = column < cells.size() ? number_in(cells[column]) : std::nullopt;
        if (!value) {
            throw Error(ErrorCode::input_unusable,
                        fmt::format("line {} has no finite number in column {}", line, column + 1));
        }
        point[a] = *value;
    }
    return point;
}

PointTable parsed(std::istream& in, PointAxes axes) {
    PointTable table;
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        if (trimmed(line).empty()) continue;
        const bool first = table.rows.empty() && !table.header;
        if (first && line.front() == '#') {
            table.comments.push_back(trimmed(line));
            continue;
        }
        Cells cells = cells_of(line);
        if (first && is_header(cells)) {
            take_header(cells, table);
            continue;
        }
        table.points.push_back(flipped(point_in(cells, table, number), axes));
        table.rows.push_back(std::move(cells));
    }
    if (table.rows.empty()) throw Error(ErrorCode::input_unusable, "it holds no point");
    return table;
}

std::string joined(const Cells& cells) { return fmt::format("{}\n", fmt::join(cells, ",")); }

}  // namespace

PointTable read_points(const std::filesystem::path& path, PointAxes axes) {
    try {
        if (const auto why = why_unreadable(path)) throw Error(ErrorCode::input_unreadable, *why);
        std::ifstream in(path, std::ios::binary);
        return parsed(in, axes);
    } catch (const Error& error) {
        throw Error(error.code(),
                    fmt::format("cannot use the points in '{}': {}", path.string(), error.what()));
    }
}

std::string points_csv(const PointTable& table, const std::vector<MovedPoint>& moved,
                       PointAxes axes) {
    constexpr std::size_t none = std::string::npos;
    const std::size_t old =
        table.header ? column_named(*table.header, inside_name).value_or(none) : none;
    std::string out;
    for (const std::string& comment : table.comments) out += comment + '\n';
    if (table.header) {
        Cells names = *table.header;
        if (old == none) names.push_back(inside_name);
        out += joined(names);
    }
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        Cells cells = table.rows[r];
        if (table.header) cells.resize(std::max(cells.size(), table.header->size()));
        const Vec3 point = flipped(moved[r].point, axes);
        for (int a = 0; a < 3; ++a) cells[table.columns[a]] = fmt::format("{:.6f}", point[a]);
        const bool was_inside = old == none || cells[old] != "0";
        const std::string inside = moved[r].inside && moved[r].found && was_inside ? "1" : "0";
        if (old == none) {
            cells.push_back(inside);
        } else {
            cells[old] = inside;
        }
        out += joined(cells);
    }
    return out;
}

}  // namespace palpate
