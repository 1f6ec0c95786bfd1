// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Named arrays in one file: how palpate and `palpate-mesh` talk. Layout, all little-endian:
/// "PALPEXC1", uint64 number of arrays; per array char name[32] (zero padded), uint32 type
/// (0 uint8, 1 int32, 2 float32, 3 float64), uint32 columns, uint64 rows, then the values, row by
/// row. Nothing may follow the last array.
class Exchange {
public:
    using Values = std::variant<std::vector<std::uint8_t>, std::vector<std::int32_t>,
                                std::vector<float>, std::vector<double>>;
    struct Array {
        std::uint32_t columns = 1;
        Values values;
    };

    /// Adds or replaces an array; the number of values must be a multiple of `columns`.
    void set(const std::string& name, Values values, std::uint32_t columns = 1);
    void set_points(const std::string& name, const std::vector<Vec3>& points);
    void set_text(const std::string& name, const std::string& text);
    template <std::size_t N>
    void set_rows(const std::string& name, const std::vector<std::array<Index, N>>& rows);

    bool has(const std::string& name) const { return arrays_.count(name) != 0; }
    /// The values of an array. Throws Error(input_unreadable) if it is absent or its type or number
    /// of columns differs.
    template <typename T>
    const std::vector<T>& get(const std::string& name, std::uint32_t columns = 1) const;
    std::vector<Vec3> points(const std::string& name) const;
    std::string text(const std::string& name) const;
    template <std::size_t N>
    std::vector<std::array<Index, N>> rows(const std::string& name) const;

    /// Throws Error(output_failed).
    void write(const std::filesystem::path& path) const;
    /// Reads and checks every size against the file. Throws Error(input_unreadable).
    static Exchange read(const std::filesystem::path& path);

private:
    [[noreturn]] static void throw_missing(const std::string& name, std::uint32_t columns);

    std::map<std::string, Array> arrays_;
};

template <typename T>
const std::vector<T>& Exchange::get(const std::string& name, std::uint32_t columns) const {
    const auto found = arrays_.find(name);
    const bool fits = found != arrays_.end() && found->second.columns == columns;
    const auto* values = fits ? std::get_if<std::vector<T>>(&found->second.values) : nullptr;
    if (!values) throw_missing(name, columns);
    return *values;
}

template <std::size_t N>
void Exchange::set_rows(const std::string& name, const std::vector<std::array<Index, N>>& rows) {
    std::vector<std::int32_t> values;
    values.reserve(rows.size() * N);
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    set(name, std::move(values), N);
}

template <std::size_t N>
std::vector<std::array<Index, N>> Exchange::rows(const std::string& name) const {
    const auto& values = get<std::int32_t>(name, N);
    std::vector<std::array<Index, N>> rows(values.size() / N);
    for (std::size_t i = 0; i < values.size(); ++i) rows[i / N][i % N] = values[i];
    return rows;
}

}  // namespace palpate
