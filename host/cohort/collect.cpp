// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/cohort/case_states.hpp"
#include "host/cohort/cohort_page.hpp"
#include "host/cohort/cohort_tables.hpp"
#include "host/cohort/plan_file.hpp"
#include "host/cohort/ratings.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr int badness_to_mark = 10;  // on the chart of patients

std::string name_of_patient(const CohortPatient& patient) {
    std::string name = patient.participant_id;
    if (patient.reference_name != "ref-01") name += ", " + patient.reference_name;
    return name;
}

bool is_computed(const CaseState& state) {
    return state.status == CaseStatus::done || state.status == CaseStatus::not_converged ||
           state.status == CaseStatus::stale;
}

bool has_modulus(const CaseState& state) {
    if (!state.record) return false;
    for (const RegionRecord& region : state.record->regions)
        if (std::isfinite(region.e_kpa)) return true;
    return false;
}

/// Why a pair enters no mean; empty: it does.
std::string why_left_out(const CohortCase& c, const CaseState& state, const std::string& rating) {
    switch (state.status) {
        case CaseStatus::excluded:
            return "excluded: " + c.excluded;
        case CaseStatus::waiting:
            return "not computed yet";
        case CaseStatus::failed:
            return "failed";
        case CaseStatus::not_converged:
            return "not converged";
        case CaseStatus::done:
        case CaseStatus::stale:
            break;
    }
    if (!has_modulus(state)) return "not identifiable";
    return rating == "reject" ? "rejected in the gallery" : "";
}

/// One case of the patient in hand.
struct CollectedCase {
    CaseFlags flags;
    std::string rating;
    bool is_used = false;
};

/// The work of one call of `collect_cohort`.
class Collection {
public:
    Collection(const CohortFolder& folder, Ratings& ratings) : folder_(folder), ratings_(ratings) {}

    void add(const CohortPatient& patient, const std::vector<CaseState>& states) {
        std::vector<CollectedCase> cases;
        for (std::size_t k = 0; k < states.size(); ++k)
            cases.push_back(judged(patient, patient.cases[k], states[k]));
        mark_unlike(states, cases);
        PatientRegion counts{patient.participant_id, patient.reference_name, ""};
        std::vector<std::size_t> numbers(states.size());
        for (std::size_t k = 0; k < states.size(); ++k) {
            const CohortCase& c = patient.cases[k];
            const CaseState& state = states[k];
            add_to(view.status, c, state);
            counts.pairs += state.status != CaseStatus::excluded;
            counts.failed += state.status == CaseStatus::failed;
            pairs_text += pair_rows(patient, c, state, cases[k].flags, cases[k].rating);
            if (state.record || state.failure)
                numbers[k] =
                    view.gallery.add(folder_, patient, c, state, cases[k].flags, cases[k].rating);
        }
        for (const std::string& name : regions_of(states))
            add_region(patient, states, cases, numbers, name, counts);
    }

    CohortView view;
    std::string pairs_text = pairs_header(), patients_text = patients_header();

private:
    CollectedCase judged(const CohortPatient& patient, const CohortCase& c,
                         const CaseState& state) {
        CollectedCase one;
        if (state.record) one.flags = state.record->flags;
        if (state.failure) one.flags.add(CaseFlag::failed);
        if (state.record || state.failure)
            one.rating = ratings_.of(patient.id, c.id, state.record ? state.record->key : c.key);
        const std::string why = why_left_out(c, state, one.rating);
        one.is_used = why.empty();
        if (one.is_used)
            view.flow.take();
        else
            view.flow.leave_out(why);
        return one;
    }

    static std::vector<std::string> regions_of(const std::vector<CaseState>& states) {
        std::vector<std::string> names;
        for (const CaseState& state : states) {
            if (!state.record) continue;
            for (const RegionRecord& region : state.record->regions)
                if (std::find(names.begin(), names.end(), region.region) == names.end())
                    names.push_back(region.region);
        }
        if (names.empty()) names.emplace_back();
        return names;
    }

    static const RegionRecord* find(const CaseState& state, const std::string& name) {
        if (!state.record) return nullptr;
        for (const RegionRecord& region : state.record->regions)
            if (region.region == name) return &region;
        return nullptr;
    }

    /// Compares the pairs of a patient with each other.
    static void mark_unlike(const std::vector<CaseState>& states,
                            std::vector<CollectedCase>& cases) {
        for (const std::string& name : regions_of(states)) {
            std::vector<std::size_t> position;
            std::vector<double> ln_e;
            for (std::size_t k = 0; k < states.size(); ++k) {
                const RegionRecord* region = find(states[k], name);
                if (!region || !std::isfinite(region->e_kpa)) continue;
                position.push_back(k);
                ln_e.push_back(std::log(region->e_kpa));
            }
            const std::vector<bool> unlike = unlike_the_others(ln_e);
            for (std::size_t k = 0; k < unlike.size(); ++k)
                if (unlike[k]) cases[position[k]].flags.add(CaseFlag::unlike_the_others);
        }
    }

    void add_region(const CohortPatient& patient, const std::vector<CaseState>& states,
                    const std::vector<CollectedCase>& cases,
                    const std::vector<std::size_t>& numbers, const std::string& name,
                    PatientRegion row) {
        row.region = name;
        PatientStrip strip{name_of_patient(patient), name, row.pairs};
        std::vector<double> kpa, ln_e;
        for (std::size_t k = 0; k < states.size(); ++k) {
            const RegionRecord* region = find(states[k], name);
            if (!region) continue;
            row.done += is_computed(states[k]);
            if (!cases[k].is_used || !std::isfinite(region->e_kpa)) continue;
            kpa.push_back(region->e_kpa);
            ln_e.push_back(std::log(region->e_kpa));
            strip.points.push_back({float(region->e_kpa), float(region->e_low_kpa),
                                    float(region->e_high_kpa), std::uint32_t(numbers[k]),
                                    region->verdict == "weak",
                                    badness(cases[k].flags) >= badness_to_mark});
        }
        row.identified = kpa.size();
        row.kpa = plain_statistics(std::move(kpa));
        row.ln_e = plain_statistics(std::move(ln_e));
        patients_text += patient_row(row);
        view.regions.push_back(std::move(row));
        view.strips.push_back(std::move(strip));
    }

    const CohortFolder& folder_;
    Ratings& ratings_;
};

std::string dataset_description() {
    nlohmann::ordered_json json{{"Name", "Stiffness by computational palpation"},
                                {"BIDSVersion", "1.8.0"},
                                {"DatasetType", "derivative"}};
    json["GeneratedBy"] =
        nlohmann::ordered_json::array({{{"Name", "palpate"}, {"Version", version_text()}}});
    return json.dump(2) + "\n";
}

Ratings ratings_for(const CollectRequest& request) {
    if (!request.ratings.empty()) return Ratings(request.ratings);
    const fs::path usual = request.cohort / "ratings.tsv";
    return fs::exists(usual) ? Ratings(usual) : Ratings();
}

}  // namespace

CollectedCohort collect_cohort(const CollectRequest& request, const ProgressSink& progress) {
    const CohortFolder folder(request.cohort);
    const PlanFile plan(request.cohort);
    const CaseStates all(folder);
    Ratings ratings = ratings_for(request);
    Collection collection(folder, ratings);
    CohortView& view = collection.view;
    view.status.patients = plan.num_patients();
    view.status.bad_rows_left_out = plan.head().num_bad_rows;
    for (std::size_t k = 0; k < plan.num_patients(); ++k) {
        report_progress(progress, "collecting", double(k) / double(plan.num_patients()),
                        fmt::format("{} of {} patients", k, plan.num_patients()));
        const CohortPatient patient = plan.patient(k);
        collection.add(patient, all.of(patient, true));
    }
    const std::size_t stale = view.status.count(CaseStatus::stale);
    if (stale > 0 && !request.mixed)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: {} results are of other settings or inputs than the plan; run "
                                "the cohort again, or take them as they are with --mixed",
                                request.cohort.string(), stale));
    view.gallery.sort();
    report_progress(progress, "writing", 0, "tables and pages");
    replace_text(request.cohort / "pairs.tsv", collection.pairs_text);
    replace_text(request.cohort / "patients.tsv", collection.patients_text);
    replace_text(request.cohort / "pairs.json", pairs_dictionary());
    replace_text(request.cohort / "patients.json", patients_dictionary());
    replace_text(request.cohort / "dataset_description.json", dataset_description());
    view.gallery.write(request.cohort, patient_pages(view));
    replace_text(request.cohort / "index.html", cohort_page(view));
    return {view.status, ratings.num_unused()};
}

}  // namespace palpate
