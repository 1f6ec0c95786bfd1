// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/plan_rows.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <unordered_map>

namespace palpate {
namespace {

const std::vector<std::string> needed_columns = {"participant_id", "reference", "target"};
const std::vector<std::string> optional_columns = {"session_id", "case_id",           "config",
                                                   "align",      "initial_transform", "exclude"};

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

void check_columns(DelimitedText& table) {
    for (const std::string& name : needed_columns)
        if (!table.find(name))
            table.faults.push_back({1, name, "the table has no such column, and needs it"});
    for (const std::string& name : table.columns)
        if (!contains(needed_columns, name) && !contains(optional_columns, name))
            table.faults.push_back(
                {1, name,
                 fmt::format("unknown column; there are {}, {}", fmt::join(needed_columns, ", "),
                             fmt::join(optional_columns, ", "))});
}

/// One row, cell by cell.
class RowCheck {
public:
    RowCheck(DelimitedText& table, const RawRow& row, const std::filesystem::path& folder)
        : table_(table), row_(row), folder_(folder), faults_before_(table.faults.size()) {}

    std::string text(const char* column) const {
        const auto at = table_.find(column);
        return at ? row_.cells[*at] : "";
    }
    std::string id(const char* column, bool is_needed) {
        const std::string found = text(column);
        if ((is_needed || !found.empty()) && !is_cohort_id(found))
            refuse(column, fmt::format("\"{}\" is no identifier; allowed: 1 to 32 letters, digits "
                                       "and hyphens, no hyphen first",
                                       found));
        return found;
    }
    std::string file(const char* column, bool is_needed) {
        const std::string found = text(column);
        if (found.empty() && is_needed) refuse(column, "the cell is empty; it must name a file");
        return found.empty() ? "" : (folder_ / found).lexically_normal().string();
    }
    void refuse(const char* column, const std::string& why) {
        table_.faults.push_back({row_.line, column, why});
    }
    bool is_good() const { return table_.faults.size() == faults_before_; }

private:
    DelimitedText& table_;
    const RawRow& row_;
    const std::filesystem::path& folder_;
    std::size_t faults_before_;
};

PlanRequestRow read_row(RowCheck& check, std::size_t line) {
    PlanRequestRow read;
    read.line = line;
    read.participant_id = check.id("participant_id", true);
    read.session_id = check.id("session_id", false);
    read.case_id = check.id("case_id", false);
    if (read.case_id == "reference")
        check.refuse("case_id", "\"reference\" is the name of another folder of the patient");
    read.config = check.text("config");
    read.exclude = check.text("exclude");
    read.reference = check.file("reference", true);
    read.target = check.file("target", true);
    read.initial_transform = check.file("initial_transform", false);
    read.align = check.text("align");
    if (!contains({"", "auto", "fixed", "centroid", "none"}, read.align))
        check.refuse("align",
                     fmt::format("\"{}\"; allowed: auto, fixed, centroid, none", read.align));
    if (!read.align.empty() && !read.initial_transform.empty())
        check.refuse("align", "the row has an initial_transform, too; one of both");
    if (!read.target.empty() && read.reference == read.target)
        check.refuse("target", "it is the same file as the reference");
    return read;
}

}  // namespace

bool is_cohort_id(const std::string& id) {
    return !id.empty() && id.size() <= 32 && id[0] != '-' &&
           std::all_of(id.begin(), id.end(), [](const char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '-';
           });
}

std::vector<TableFault> for_each_plan_row(std::string_view text, const DelimitedFormat& format,
                                          const std::filesystem::path& folder,
                                          const std::function<void(PlanRequestRow& row)>& take) {
    DelimitedText table;
    bool is_checked = false, is_understood = true;
    std::size_t rows = 0;
    std::unordered_map<std::uint64_t, std::size_t> line_of;  // hashes of what stands only once
    read_delimited(text, format, table, [&](RawRow& raw) {
        ++rows;
        if (!is_checked) {
            is_checked = true;
            check_columns(table);
            is_understood = std::none_of(table.faults.begin(), table.faults.end(),
                                         [](const TableFault& fault) { return fault.line <= 1; });
        }
        if (!is_understood) return;
        RowCheck check(table, raw, folder);
        PlanRequestRow row = read_row(check, raw.line);
        const auto refuse_second = [&](const std::string& name, const char* column) {
            const auto [found, is_new] =
                line_of.try_emplace(std::hash<std::string>{}(name), row.line);
            if (!is_new) check.refuse(column, fmt::format("line {} has the same", found->second));
        };
        if (!row.case_id.empty())
            refuse_second("case\n" + row.participant_id + '\n' + row.case_id, "case_id");
        refuse_second("pair\n" + row.participant_id + '\n' + row.reference + '\n' + row.target +
                          '\n' + row.config,
                      "target");
        if (check.is_good()) take(row);
    });
    if (!is_checked && !table.columns.empty()) check_columns(table);
    if (rows == 0 && table.faults.empty())
        table.faults.push_back({0, "", "the table has a header and no rows"});
    return std::move(table.faults);
}

}  // namespace palpate
