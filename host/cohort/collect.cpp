// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/io/delimited_text.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
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
    {"key", "", "SHA-256 of everything the answer depends on"}};

constexpr ColumnMeaning patient_columns[] = {
    {"participant_id", "", "As in the table that was planned"},
    {"reference", "", "Number of the reference among those of the participant"},
    {"region", "", "Organ whose modulus was unknown"},
    {"pairs", "", "Pairs of this reference that were not excluded"},
    {"done", "", "Pairs with a result"},
    {"failed", "", "Pairs that failed"},
    {"identified", "", "Pairs with a modulus"},
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

std::vector<std::string> first_cells(const CohortPatient& p, const CohortCase& c,
                                     const CaseState& state) {
    return {p.participant_id, p.reference_name,      c.target_name,   c.session_id, c.id,
            p.config,         name_of(state.status), code_cell(state)};
}

std::string row_of_region(std::vector<std::string> cells, const CaseRecord& record,
                          const RegionRecord& r, const std::string& key) {
    cells.insert(cells.end(), {r.verdict, r.region});
    for (const double value :
         {r.e_kpa, std::log(r.e_kpa), r.sd_ln, r.e_low_kpa, r.e_high_kpa, r.ln_e_data, r.sd_data,
          record.contour_sd_mm, r.dice, r.mean_distance_mm, record.seconds, record.peak_memory_mb})
        cells.push_back(number_cell(value));
    cells.insert(cells.end(), {record.device, record.host, key});
    return delimited_line(cells, '\t');
}

std::string row_without_result(std::vector<std::string> cells, const CohortCase& c,
                               const CaseState& state) {
    cells.push_back(state.failure ? state.failure->sentence : c.excluded);
    cells.resize(std::size(pair_columns) - 2);
    cells.insert(cells.end(), {state.failure ? state.failure->host : "", c.key});
    return delimited_line(cells, '\t');
}

/// The work of one call of `collect_cohort`.
class Collection {
public:
    void add(const CohortPatient& patient, const std::vector<CaseState>& states) {
        std::vector<PatientRegion> regions;
        std::size_t pairs = 0, failed = 0;
        for (std::size_t k = 0; k < states.size(); ++k) {
            const CohortCase& c = patient.cases[k];
            const CaseState& state = states[k];
            add_to(status, c, state);
            pairs += state.status != CaseStatus::excluded;
            failed += state.status == CaseStatus::failed;
            const std::vector<std::string> cells = first_cells(patient, c, state);
            if (!state.record || state.record->regions.empty())
                pairs_text += row_without_result(cells, c, state);
            if (!state.record) continue;
            for (const RegionRecord& region : state.record->regions) {
                pairs_text += row_of_region(cells, *state.record, region, state.record->key);
                find(regions, patient, region.region).found.emplace_back(c.target_name, region);
            }
        }
        if (regions.empty()) regions.push_back({&patient, ""});
        for (PatientRegion& region : regions) {
            region.pairs = pairs;
            region.failed = failed;
            region.done = region.found.size();
            patients_text += patient_line(region);
            all.push_back(std::move(region));
        }
    }

    CohortStatus status;
    std::string pairs_text = header_line(pair_columns);
    std::string patients_text = header_line(patient_columns);
    std::vector<PatientRegion> all;

private:
    static PatientRegion& find(std::vector<PatientRegion>& regions, const CohortPatient& patient,
                               const std::string& name) {
        for (PatientRegion& region : regions)
            if (region.region == name) return region;
        regions.push_back({&patient, name});
        return regions.back();
    }

    static std::string patient_line(const PatientRegion& region) {
        const std::vector<double> kpa = region.identified_kpa();
        std::vector<double> logarithms;
        for (const double value : kpa) logarithms.push_back(std::log(value));
        const PlainStatistics plain = plain_statistics(kpa), ln = plain_statistics(logarithms);
        return delimited_line(
            {region.patient->participant_id, region.patient->reference_name, region.region,
             fmt::to_string(region.pairs), fmt::to_string(region.done),
             fmt::to_string(region.failed), fmt::to_string(kpa.size()), number_cell(plain.mean),
             number_cell(plain.sd), number_cell(plain.median), number_cell(ln.mean),
             number_cell(ln.sd)},
            '\t');
    }
};

std::string dataset_description() {
    nlohmann::ordered_json json{{"Name", "Stiffness by computational palpation"},
                                {"BIDSVersion", "1.8.0"},
                                {"DatasetType", "derivative"}};
    json["GeneratedBy"] =
        nlohmann::ordered_json::array({{{"Name", "palpate"}, {"Version", version_text()}}});
    return json.dump(2) + "\n";
}

}  // namespace

std::vector<double> PatientRegion::identified_kpa() const {
    std::vector<double> kpa;
    for (const auto& [target, region_record] : found)
        if (std::isfinite(region_record.e_kpa)) kpa.push_back(region_record.e_kpa);
    return kpa;
}

PlainStatistics plain_statistics(std::vector<double> values) {
    PlainStatistics result{RegionRecord::none, RegionRecord::none, RegionRecord::none};
    if (values.empty()) return result;
    const double n = double(values.size());
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    result.mean = sum / n;
    for (const double value : values) squares += (value - result.mean) * (value - result.mean);
    if (values.size() > 1) result.sd = std::sqrt(squares / (n - 1));
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    result.median = values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
    return result;
}

CohortStatus collect_cohort(const fs::path& path, bool mixed, const ProgressSink& progress) {
    const CohortFolder folder(path);
    const CohortPlan plan = read_plan(path);
    const Journals journals(folder);
    Collection collection;
    collection.status.patients = plan.patients.size();
    collection.status.bad_rows_left_out = plan.num_bad_rows;
    for (std::size_t k = 0; k < plan.patients.size(); ++k) {
        report_progress(progress, "collecting", double(k) / double(plan.patients.size()),
                        fmt::format("{} of {} patients", k, plan.patients.size()));
        collection.add(plan.patients[k], states_of(folder, journals, plan.patients[k]));
    }
    const std::size_t stale = collection.status.count(CaseStatus::stale);
    if (stale > 0 && !mixed)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: {} results are of other settings or inputs than the plan; run "
                                "the cohort again, or take them as they are with --mixed",
                                path.string(), stale));
    for (const auto& [name, text] :
         {std::pair<const char*, std::string>{"pairs.tsv", collection.pairs_text},
          {"patients.tsv", collection.patients_text},
          {"pairs.json", dictionary(pair_columns)},
          {"patients.json", dictionary(patient_columns)},
          {"dataset_description.json", dataset_description()},
          {"index.html", cohort_page(collection.status, collection.all)}})
        replace_text(path / name, text);
    return collection.status;
}

}  // namespace palpate
