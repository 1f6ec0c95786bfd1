// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/plan_rows.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

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
    RowCheck(DelimitedText& table, std::size_t row, const std::filesystem::path& folder)
        : table_(table), row_(row), folder_(folder), faults_before_(table.faults.size()) {}

    std::string text(const char* column) const {
        const auto at = table_.find(column);
        return at ? table_.rows[row_][*at] : "";
    }
    std::string id(const char* column, bool is_needed) {
        const std::string found = text(column);
        if ((is_needed || !found.empty()) && !is_cohort_id(found))
            refuse(column, fmt::format("\"{}\" is no identifier; allowed: 1 to 32 letters, digits "
                                       "and hyphens, no hyphen first",
                                       found));
        return found;
    }
    std::filesystem::path file(const char* column, bool is_needed) {
        const std::string found = text(column);
        if (found.empty() && is_needed) refuse(column, "the cell is empty; it must name a file");
        return found.empty() ? std::filesystem::path() : (folder_ / found).lexically_normal();
    }
    void refuse(const char* column, const std::string& why) {
        table_.faults.push_back({table_.lines[row_], column, why});
    }
    bool is_good() const { return table_.faults.size() == faults_before_; }

private:
    DelimitedText& table_;
    std::size_t row_;
    const std::filesystem::path& folder_;
    std::size_t faults_before_;
};

PlanRequestRow read_row(DelimitedText& table, RowCheck& check, std::size_t row) {
    PlanRequestRow read;
    read.line = table.lines[row];
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

std::vector<PlanRequestRow> plan_rows(DelimitedText& table, const std::filesystem::path& folder) {
    const bool has_header = !table.columns.empty();
    if (has_header) check_columns(table);
    for (const TableFault& fault : table.faults)
        if (fault.line <= 1) return {};  // rows cannot be understood
    std::vector<PlanRequestRow> rows;
    std::map<std::string, std::size_t> line_of;
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        RowCheck check(table, k, folder);
        PlanRequestRow row = read_row(table, check, k);
        const auto refuse_second = [&](const std::string& name, const char* column) {
            const auto [found, is_new] = line_of.try_emplace(name, row.line);
            if (!is_new) check.refuse(column, fmt::format("line {} has the same", found->second));
        };
        if (!row.case_id.empty())
            refuse_second("case\n" + row.participant_id + '\n' + row.case_id, "case_id");
        refuse_second("pair\n" + row.participant_id + '\n' + row.reference.string() + '\n' +
                          row.target.string() + '\n' + row.config,
                      "target");
        if (check.is_good()) rows.push_back(std::move(row));
    }
    if (table.rows.empty() && table.faults.empty())
        table.faults.push_back({0, "", "the table has a header and no rows"});
    return rows;
}

}  // namespace palpate
