// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/data_kinds.hpp"

#include <fmt/format.h>

#include <array>

#include "host/apps/simulate/setting_values.hpp"

namespace palpate {
namespace {

constexpr std::array<std::string_view, 7> common_keys{
    "kind", "name", "file", "correlation_mm", "correlation_s", "discrepancy", "robust"};

const DataKind& kind_of(const SettingsTable& table) {
    std::string names;
    for (const DataKind& kind : data_kinds())
        names += (names.empty() ? "\"" : ", \"") + std::string(kind.name) + '"';
    const auto name = table.text("kind");
    if (!name) table.missing("kind", names);
    for (const DataKind& kind : data_kinds())
        if (kind.name == *name) return kind;
    table.refuse("kind", "allowed: " + names);
}

}  // namespace

const std::vector<DataKind>& data_kinds() {
    static const std::vector<DataKind> kinds{force_kind(),          displacement_kind(),
                                             points_kind(),         profile_kind(),
                                             stress_stretch_kind(), relaxation_kind()};
    return kinds;
}

std::unique_ptr<MeasuredData> read_data(const SettingsTable& table, std::size_t number,
                                        DataTables& tables) {
    const DataKind& kind = kind_of(table);
    std::vector<std::string_view> keys(common_keys.begin(), common_keys.end());
    keys.insert(keys.end(), kind.keys.begin(), kind.keys.end());
    table.allow_keys(keys);
    const auto file = table.text("file");
    if (!file) table.missing("file", "a table of comma-separated values");
    auto data = kind.read({table, tables.read(*file)});
    DataBlock& block = data->block_;
    block.name = table.text("name").value_or(fmt::format("data {}", number));
    block.kind = kind.name;
    block.correlation_mm = table.number("correlation_mm", positive).value_or(0);
    block.correlation_s = table.number("correlation_s", positive).value_or(0);
    block.has_discrepancy = table.yes_or_no("discrepancy").value_or(true);
    block.is_robust = table.yes_or_no("robust").value_or(true);
    return data;
}

}  // namespace palpate
