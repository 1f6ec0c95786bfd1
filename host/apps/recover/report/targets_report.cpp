// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/targets_report.hpp"

#include <fmt/format.h>

#include <limits>
#include <set>
#include <utility>

#include "host/apps/recover/report/findings.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/page/plain_text.hpp"

namespace palpate {
namespace {

/// The unknown regions of a row, or one without name where there is none.
std::vector<RegionResult> listed_regions(const TargetRow& row) {
    if (!row.unknown.empty()) return row.unknown;
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    RegionResult region;
    region.stiffness_kpa = none;
    region.interval_kpa = {none, none};
    return {region};
}

/// The verdict in words; of a row without regions, whether it failed.
std::string verdict_words(const TargetRow& row, const RegionResult& region) {
    if (!row.unknown.empty()) return name_of(region.verdict);
    return row.converged ? "" : "failed";
}

bool lists_ratios(const std::vector<TargetRow>& rows) {
    return std::any_of(rows.begin(), rows.end(), [](const TargetRow& row) {
        return std::any_of(row.unknown.begin(), row.unknown.end(),
                           [](const RegionResult& region) { return region.ratio.has_value(); });
    });
}

void add_ratio_cells(const RegionResult& region, std::vector<std::string>& cells) {
    if (!region.ratio) {
        cells.insert(cells.end(), 3, "-");
        return;
    }
    cells.push_back(decimals(region.poisson_ratio, 2));
    cells.push_back(fmt::format("{} to {}", decimals(region.ratio->interval[0], 2),
                                decimals(region.ratio->interval[1], 2)));
    cells.push_back(name_of(region.ratio->verdict));
}

/// ",ratio,low,high,verdict" of a ratio that was searched, else as many empty cells.
std::string ratio_csv(const RegionResult& region) {
    if (!region.ratio) return ",,,,";
    return fmt::format(",{},{},{},{}", csv_number(region.poisson_ratio),
                       csv_number(region.ratio->interval[0]), csv_number(region.ratio->interval[1]),
                       csv_text(name_of(region.ratio->verdict)));
}

std::string without_endings(const std::filesystem::path& file) {
    static const std::set<std::string> endings{".gz",  ".nii", ".nrrd", ".nhdr",
                                               ".mha", ".mhd", ".hdr",  ".img"};
    std::filesystem::path name = file.filename();
    while (endings.contains(name.extension().string())) name = name.stem();
    return name.string();
}

}  // namespace

TargetRow target_row(std::string name, const RecoveryResult& result, double seconds) {
    TargetRow row;
    row.name = std::move(name);
    for (const RegionResult& region : result.regions) {
        if (region.unknown || region.ratio) row.unknown.push_back(region);
    }
    row.converged = result.termination.converged;
    row.seconds = seconds;
    if (!row.converged) row.note = termination_sentence(result);
    return row;
}

TargetRow joint_row(JointResult result, const std::vector<std::string>& names) {
    if (!result.failure.empty()) return failed_row(joint_row_name, result.failure);
    std::string note = fmt::format(
        "of {} targets together, the contours of the reference common to all", result.num_targets);
    for (std::size_t k = 0; k < result.left_out.size(); ++k)
        note += fmt::format("{}{} {}", k == 0 ? "; left out: " : ", ",
                            names[result.left_out[k].first], result.left_out[k].second);
    return {joint_row_name, std::move(result.regions), true, result.seconds, std::move(note)};
}

TargetRow failed_row(std::string name, const std::string& message) {
    return {std::move(name), {}, false, std::numeric_limits<double>::quiet_NaN(), message};
}

std::string targets_table(const std::vector<TargetRow>& rows) {
    const bool has_ratios = lists_ratios(rows);
    std::vector<std::string> header{"Target",        "Region",  "Stiffness kPa",
                                    "95 % interval", "Verdict", "Seconds"};
    std::vector<bool> to_the_right{false, false, true, true, false, true};
    if (has_ratios) {
        header.insert(header.end(), {"Poisson's ratio", "95 % interval", "Verdict"});
        to_the_right.insert(to_the_right.end(), {true, true, false});
    }
    TextTable table(header, to_the_right);
    std::string notes;
    for (const TargetRow& row : rows) {
        for (const RegionResult& r : listed_regions(row)) {
            const std::string interval = fmt::format("{} to {}", significant(r.interval_kpa[0]),
                                                     significant(r.interval_kpa[1]));
            const std::string value =
                r.verdict == Verdict::not_identifiable ? "-" : significant(r.stiffness_kpa);
            std::vector<std::string> cells{
                harmless(row.name), harmless(r.name),      value,
                interval,           verdict_words(row, r), decimals(row.seconds, 1)};
            if (has_ratios) add_ratio_cells(r, cells);
            table.add(std::move(cells));
        }
        if (!row.note.empty()) notes += harmless(row.name + ": " + row.note) + '\n';
    }
    return table.text() + (notes.empty() ? "" : '\n' + notes);
}

std::string targets_csv(const std::vector<TargetRow>& rows) {
    std::string out =
        "target,region,stiffness_kpa,low_kpa,high_kpa,verdict,converged,seconds,note,"
        "poisson_ratio,low_ratio,high_ratio,ratio_verdict\n";
    for (const TargetRow& row : rows) {
        for (const RegionResult& r : listed_regions(row)) {
            out += fmt::format("{},{},{},{},{},{},{:d},{},{}{}\n", csv_text(row.name),
                               csv_text(r.name), csv_number(r.stiffness_kpa),
                               csv_number(r.interval_kpa[0]), csv_number(r.interval_kpa[1]),
                               csv_text(verdict_words(row, r)), row.converged,
                               csv_number(row.seconds), csv_text(row.note), ratio_csv(r));
        }
    }
    return out;
}

std::vector<std::string> target_folder_names(const std::vector<std::filesystem::path>& targets) {
    std::set<std::string> taken{targets_file_name, targets_page_name, joint_row_name};
    std::vector<std::string> names;
    for (const auto& target : targets) {
        std::string stem = without_endings(target);
        if (stem.empty() || stem.front() == '.') stem = "target";
        std::string name = stem;
        for (int number = 2; !taken.insert(name).second; ++number) {
            name = fmt::format("{}-{}", stem, number);
        }
        names.push_back(std::move(name));
    }
    return names;
}

std::vector<std::string> numbered_folder_names(std::size_t num_targets) {
    std::vector<std::string> names;
    for (std::size_t k = 1; k <= num_targets; ++k) names.push_back(fmt::format("target-{}", k));
    return names;
}

}  // namespace palpate
