// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/report/text_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/report/findings.hpp"

namespace palpate {
namespace {

/// Characters of UTF-8 text: every byte but the continuation bytes.
std::size_t width_of(const std::string& text) {
    return std::count_if(text.begin(), text.end(),
                         [](unsigned char c) { return (c & 0xc0) != 0x80; });
}

std::string harmless(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text;
}

/// Rows of text in aligned columns, numbers to the right.
class TextTable {
public:
    TextTable(std::vector<std::string> header, std::vector<bool> to_the_right)
        : rows_{std::move(header)}, to_the_right_(std::move(to_the_right)) {}

    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

    std::string text() const {
        std::vector<std::size_t> widths(to_the_right_.size(), 0);
        for (const auto& row : rows_)
            for (std::size_t c = 0; c < widths.size(); ++c)
                widths[c] = std::max(widths[c], width_of(row[c]));
        std::string out;
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            out += line(rows_[r], widths);
            if (r == 0) out += rule(widths);
        }
        return out;
    }

private:
    std::string line(const std::vector<std::string>& row,
                     const std::vector<std::size_t>& widths) const {
        std::string out;
        for (std::size_t c = 0; c < widths.size(); ++c) {
            const std::string blanks(widths[c] - width_of(row[c]), ' ');
            out += to_the_right_[c] ? blanks + row[c] : row[c] + blanks;
            out += "  ";
        }
        return out.substr(0, out.find_last_not_of(' ') + 1) + '\n';
    }

    static std::string rule(const std::vector<std::size_t>& widths) {
        std::string out;
        for (std::size_t w : widths) out += std::string(w, '-') + "  ";
        return out.substr(0, out.size() - 2) + '\n';
    }

    std::vector<std::vector<std::string>> rows_;
    std::vector<bool> to_the_right_;
};

std::string regions_table(const RecoveryResult& result) {
    TextTable table({"Region", "Label", "Role", "Stiffness kPa", "95 % interval", "Verdict"},
                    {false, true, false, true, true, false});
    for (const RegionResult& r : result.regions) {
        const std::string interval =
            fmt::format("{} to {}", significant(r.interval_kpa[0]), significant(r.interval_kpa[1]));
        table.add({harmless(r.name), fmt::format("{}", r.label), r.role,
                   r.hollow ? "-" : significant(r.stiffness_kpa), r.unknown ? interval : "-",
                   r.verdict});
    }
    return table.text();
}

std::string surfaces_table(const RecoveryResult& result) {
    TextTable table({"Surface", "Role", "Dice before", "after", "Mean mm before", "after",
                     "Max mm before", "after"},
                    {false, false, true, true, true, true, true, true});
    for (const SurfaceResult& s : result.surfaces)
        table.add({harmless(s.name) + (s.cut_by_image ? " *" : ""), s.role,
                   decimals(s.dice_before, 3), decimals(s.dice_after, 3),
                   decimals(s.mean_distance_mm_before, 2), decimals(s.mean_distance_mm_after, 2),
                   decimals(s.max_distance_mm_before, 2), decimals(s.max_distance_mm_after, 2)});
    return table.text();
}

std::string csv_number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string csv_text(const std::string& text) {
    std::string out = "\"";
    for (char c : harmless(text)) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + '"';
}

}  // namespace

std::string text_report(const RecoveryResult& result) {
    std::string out = regions_table(result);
    if (!result.surfaces.empty()) out += '\n' + surfaces_table(result);
    if (std::any_of(result.surfaces.begin(), result.surfaces.end(),
                    [](const SurfaceResult& s) { return s.cut_by_image; }))
        out += "* cut by the field of view; the cut face carries no data\n";
    out += '\n';
    for (const std::string& warning : result.warnings)
        out += "Warning: " + harmless(warning) + '\n';
    if (const std::string solvers = linear_solvers_text(result); !solvers.empty())
        out += "Linear solvers, " + harmless(solvers) + '\n';
    return out + harmless(termination_sentence(result)) + '\n';
}

std::string convergence_csv(const RecoveryResult& result) {
    std::string out = "iteration,objective,gradient_norm,step";
    std::size_t num_unknown = 0;
    for (const RegionResult& r : result.regions) {
        if (!r.unknown) continue;
        out += ',' + csv_text("stiffness_kpa " + r.name);
        ++num_unknown;
    }
    out += '\n';
    for (const IterationRecord& i : result.convergence) {
        out += fmt::format("{},{},{},{}", i.iteration, csv_number(i.objective),
                           csv_number(i.gradient_norm), csv_number(i.step));
        for (std::size_t u = 0; u < num_unknown; ++u)
            out += ',' + (u < i.stiffness_kpa.size() ? csv_number(i.stiffness_kpa[u]) : "");
        out += '\n';
    }
    return out;
}

}  // namespace palpate
