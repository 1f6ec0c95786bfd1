// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/report/targets_report.hpp"

#include <fmt/format.h>

#include <limits>
#include <set>
#include <utility>

#include "host/report/findings.hpp"
#include "host/report/plain_text.hpp"
#include "host/report/result_folder.hpp"

namespace palpate {
namespace {

/// The unknown regions of a row, or one without name where there is none.
std::vector<RegionResult> listed_regions(const TargetRow& row) {
    if (!row.unknown.empty()) return row.unknown;
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    RegionResult region;
    region.stiffness_kpa = none;
    region.interval_kpa = {none, none};
    region.verdict = row.converged ? "" : "failed";
    return {region};
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
        if (region.unknown) row.unknown.push_back(region);
    }
    row.converged = result.termination.converged;
    row.seconds = seconds;
    if (!row.converged) row.note = termination_sentence(result);
    return row;
}

TargetRow failed_row(std::string name, const std::string& message) {
    return {std::move(name), {}, false, std::numeric_limits<double>::quiet_NaN(), message};
}

std::string targets_table(const std::vector<TargetRow>& rows) {
    TextTable table({"Target", "Region", "Stiffness kPa", "95 % interval", "Verdict", "Seconds"},
                    {false, false, true, true, false, true});
    std::string notes;
    for (const TargetRow& row : rows) {
        for (const RegionResult& r : listed_regions(row)) {
            const std::string interval = fmt::format("{} to {}", significant(r.interval_kpa[0]),
                                                     significant(r.interval_kpa[1]));
            table.add({harmless(row.name), harmless(r.name), significant(r.stiffness_kpa), interval,
                       r.verdict, decimals(row.seconds, 1)});
        }
        if (!row.note.empty()) notes += harmless(row.name + ": " + row.note) + '\n';
    }
    return table.text() + (notes.empty() ? "" : '\n' + notes);
}

std::string targets_csv(const std::vector<TargetRow>& rows) {
    std::string out =
        "target,region,stiffness_kpa,low_kpa,high_kpa,verdict,converged,seconds,note\n";
    for (const TargetRow& row : rows) {
        for (const RegionResult& r : listed_regions(row)) {
            out +=
                fmt::format("{},{},{},{},{},{},{:d},{},{}\n", csv_text(row.name), csv_text(r.name),
                            csv_number(r.stiffness_kpa), csv_number(r.interval_kpa[0]),
                            csv_number(r.interval_kpa[1]), csv_text(r.verdict), row.converged,
                            csv_number(row.seconds), csv_text(row.note));
        }
    }
    return out;
}

std::vector<std::string> target_folder_names(const std::vector<std::filesystem::path>& targets) {
    std::set<std::string> taken{targets_file_name};
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

}  // namespace palpate
