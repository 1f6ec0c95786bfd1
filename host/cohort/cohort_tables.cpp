// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/cohort_tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/io/delimited_text.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Name, unit and meaning of a column.
struct ColumnMeaning {
    const char *name, *unit, *meaning;
};

constexpr ColumnMeaning pair_columns[] = {
    {"participant_id", "", "As in the table that was planned"},
    {"reference", "", "Number of the reference among those of the participant"},
    {"target", "", "Number of the target among those of the reference"},
    {"session_id", "", "As in the table"},
    {"case_id", "", "As in the table, else the target"},
    {"config", "", "Name of the settings in the folder settings"},
    {"status", "", "done, not converged, failed, stale, waiting or excluded"},
    {"code", "", "Exit code of the case"},
    {"verdict", "", "What the data say of the modulus; of a case without result its reason"},
    {"region", "", "Organ whose modulus was unknown"},
    {"e_kpa", "kPa", "Young's modulus; empty where it is not identifiable"},
    {"ln_e", "", "Natural logarithm of e_kpa"},
    {"sd_ln", "", "Standard deviation of ln_e"},
    {"e_low_kpa", "kPa", "Lower end of the 95 % interval; the prior's if not identifiable"},
    {"e_high_kpa", "kPa", "Upper end of the 95 % interval; the prior's if not identifiable"},
    {"ln_e_data", "", "As ln_e, with the prior taken out"},
    {"sd_data", "", "As sd_ln, with the prior taken out"},
    {"contour_sd_mm", "mm", "How far the contours of one image are off"},
    {"dice", "", "Overlap of the organ after the deformation"},
    {"mean_distance_mm", "mm", "Of the organ's surface to the target's, after the deformation"},
    {"seconds", "s", "Of this pair alone, by the clock"},
    {"peak_memory_mb", "MB", "Largest memory of the process up to the end of this pair"},
    {"device", "", "That computed"},
    {"host", "", "Name of the machine"},
    {"key", "", "SHA-256 of everything the answer depends on"},
    {"flags", "", "Why a person should look at the case, with semicolons"},
    {"rating", "", "What a person said of it: accept, reject or unsure"}};

constexpr ColumnMeaning patient_columns[] = {
    {"participant_id", "", "As in the table that was planned"},
    {"reference", "", "Number of the reference among those of the participant"},
    {"region", "", "Organ whose modulus was unknown"},
    {"pairs", "", "Pairs of this reference that were not excluded"},
    {"done", "", "Pairs with a result"},
    {"failed", "", "Pairs that failed"},
    {"identified", "", "Pairs with a modulus that nobody rejected; means are of these"},
    {"mean_kpa", "kPa", "Plain mean of the moduli"},
    {"sd_kpa", "kPa", "Their standard deviation over n - 1"},
    {"median_kpa", "kPa", "Their median"},
    {"mean_ln_e", "", "Plain mean of ln E"},
    {"sd_ln_e", "", "Its standard deviation over n - 1"}};

template <std::size_t n>
std::string header_line(const ColumnMeaning (&columns)[n]) {
    std::vector<std::string> names;
    for (const ColumnMeaning& column : columns) names.emplace_back(column.name);
    return delimited_line(names, '\t');
}

template <std::size_t n>
std::string dictionary(const ColumnMeaning (&columns)[n]) {
    nlohmann::ordered_json json;
    for (const ColumnMeaning& column : columns) {
        json[column.name]["Description"] = column.meaning;
        if (*column.unit) json[column.name]["Units"] = column.unit;
    }
    return json.dump(2) + "\n";
}

std::string number_cell(double value) {
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : "";
}

std::string code_cell(const CaseState& state) {
    if (state.failure) return fmt::to_string(state.failure->code);
    if (!state.record) return "";
    return state.record->converged ? "0" : fmt::to_string(exit_code_not_converged);
}

std::string flags_cell(CaseFlags flags) {
    std::string text;
    for (std::size_t k = 0; k < num_case_flags; ++k) {
        const auto flag = static_cast<CaseFlag>(k);
        if (!flags.has(flag)) continue;
        text += text.empty() ? "" : "; ";
        text += name_of(flag);
    }
    return text;
}

std::vector<std::string> first_cells(const CohortPatient& p, const CohortCase& c,
                                     const CaseState& state) {
    return {p.participant_id, p.reference_name,      c.target_name,   c.session_id, c.id,
            p.config,         name_of(state.status), code_cell(state)};
}

}  // namespace

std::string pairs_header() { return header_line(pair_columns); }
std::string patients_header() { return header_line(patient_columns); }
std::string pairs_dictionary() { return dictionary(pair_columns); }
std::string patients_dictionary() { return dictionary(patient_columns); }

std::string pair_rows(const CohortPatient& patient, const CohortCase& c, const CaseState& state,
                      CaseFlags flags, const std::string& rating) {
    std::vector<std::string> first = first_cells(patient, c, state);
    if (!state.record || state.record->regions.empty()) {
        first.push_back(state.failure ? state.failure->sentence : c.excluded);
        first.resize(std::size(pair_columns) - 4);
        first.insert(first.end(),
                     {state.failure ? state.failure->host : "", c.key, flags_cell(flags), rating});
        return delimited_line(first, '\t');
    }
    std::string rows;
    const CaseRecord& record = *state.record;
    for (const RegionRecord& r : record.regions) {
        std::vector<std::string> cells = first;
        cells.insert(cells.end(), {r.verdict, r.region});
        for (const double value : {r.e_kpa, std::log(r.e_kpa), r.sd_ln, r.e_low_kpa, r.e_high_kpa,
                                   r.ln_e_data, r.sd_data, record.contour_sd_mm, r.dice,
                                   r.mean_distance_mm, record.seconds, record.peak_memory_mb})
            cells.push_back(number_cell(value));
        cells.insert(cells.end(),
                     {record.device, record.host, record.key, flags_cell(flags), rating});
        rows += delimited_line(cells, '\t');
    }
    return rows;
}

std::string patient_row(const PatientRegion& r) {
    return delimited_line(
        {r.participant_id, r.reference, r.region, fmt::to_string(r.pairs), fmt::to_string(r.done),
         fmt::to_string(r.failed), fmt::to_string(r.identified), number_cell(r.kpa.mean),
         number_cell(r.kpa.sd), number_cell(r.kpa.median), number_cell(r.ln_e.mean),
         number_cell(r.ln_e.sd)},
        '\t');
}

}  // namespace palpate
