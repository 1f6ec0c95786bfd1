// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/plan_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "host/cohort/content_key.hpp"
#include "host/io/delimited_text.hpp"
#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr const char* plan_format = "palpate-cohort-plan";
constexpr int plan_format_version = 2;
constexpr std::size_t rows_digits = 16;  // of the SHA-256 of a patient's rows

enum PlanColumn {
    column_patient,
    column_participant,
    column_reference,
    column_target,
    column_session,
    column_case,
    column_config,
    column_align,
    column_exclude,
    column_key,
    column_reference_sha256,
    column_target_sha256,
    column_estimate,
    column_reference_file,
    column_target_file,
    column_transform,
    num_plan_columns
};
const std::vector<std::string> plan_columns = {
    "patient",          "participant_id", "reference",  "target",         "session_id",
    "case_id",          "config",         "align",      "exclude",        "key",
    "reference_sha256", "target_sha256",  "estimate_s", "reference_file", "target_file",
    "initial_transform"};
const std::vector<std::string> patients_columns = {"patient", "rows_begin", "rows_bytes",
                                                   "cases",   "estimate_s", "rows_sha256"};

std::string plan_rows_of(const CohortPatient& p) {
    std::string text;
    for (const CohortCase& c : p.cases)
        text += delimited_line(
            {p.id, p.participant_id, p.reference_name, c.target_name, c.session_id, c.id, p.config,
             p.align, c.excluded, c.key, p.reference_sha256, c.target_sha256,
             fmt::format("{:.1f}", p.estimate_s), p.reference, c.target, p.initial_transform},
            '\t');
    return text;
}

void make_read_only(const fs::path& path) {
    std::error_code ignored;
    fs::permissions(path, fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write,
                    fs::perm_options::remove, ignored);
}

[[noreturn]] void refuse_plan(const fs::path& folder, const std::string& why) {
    throw Error(ErrorCode::input_unreadable,
                fmt::format("{}: {}; make it with `palpate cohort plan`", folder.string(), why));
}

PlanHead head_of(const nlohmann::ordered_json& json) {
    PlanHead head;
    head.keep = kept_files_of(json.at("keep").get<std::string>());
    head.recover_toml = json.at("recover");
    head.shard_minutes = json.at("shard_minutes");
    const nlohmann::ordered_json& limits = json.at("limits");
    head.limits = {limits.at("target_s"), limits.at("attempts"),
                   limits.value("memory_mb", HUGE_VAL)};
    head.slurm_lines = json.at("slurm");
    head.num_bad_rows = json.at("bad_rows_left_out");
    if (json.contains("test_stub_s")) head.test_stub_s = json["test_stub_s"].get<double>();
    return head;
}

std::size_t num_cases_of(const CohortPatient& patient) {
    return static_cast<std::size_t>(
        std::count_if(patient.cases.begin(), patient.cases.end(),
                      [](const CohortCase& c) { return c.excluded.empty(); }));
}

/// Writes plan.tsv; returns the text of plan_patients.tsv.
std::string write_rows(const CohortPlan& plan, const fs::path& file) {
    std::string places = delimited_line(patients_columns, '\t');
    write_atomically(file, [&](const fs::path& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        out.exceptions(std::ios::badbit | std::ios::failbit);
        const std::string header = delimited_line(plan_columns, '\t');
        out << header;
        std::uint64_t at = header.size();
        for (const CohortPatient& patient : plan.patients) {
            const std::string rows = plan_rows_of(patient);
            out << rows;
            places += delimited_line(
                {patient.id, fmt::to_string(at), fmt::to_string(rows.size()),
                 fmt::to_string(num_cases_of(patient)), fmt::format("{:.1f}", patient.estimate_s),
                 sha256_of(rows).substr(0, rows_digits)},
                '\t');
            at += rows.size();
        }
        out.close();
    });
    return places;
}

}  // namespace

void write_plan(const CohortPlan& plan, const fs::path& folder) {
    for (const char* name : {"cases", "failed", "journal", "logs", "engines"})
        make_folders(folder / name);
    const std::string places = write_rows(plan, folder / "plan.tsv");
    nlohmann::ordered_json json{{"format", plan_format},
                                {"format_version", plan_format_version},
                                {"version", version_text()},
                                {"numerics_version", numerics_version},
                                {"patients", plan.patients.size()},
                                {"cases", plan.num_cases()},
                                {"bad_rows_left_out", plan.num_bad_rows},
                                {"keep", name_of(plan.keep)},
                                {"shard_minutes", plan.shard_minutes},
                                {"recover", plan.recover_toml},
                                {"limits",
                                 {{"target_s", plan.limits.target_s},
                                  {"attempts", plan.limits.attempts},
                                  {"memory_mb", plan.limits.memory_mb}}},
                                {"slurm", plan.slurm_lines},
                                {"plan_patients_sha256", sha256_of(places)}};
    if (plan.test_stub_s) json["test_stub_s"] = *plan.test_stub_s;
    replace_text(folder / "plan_patients.tsv", places);
    replace_text(folder / "plan.json", json.dump(2) + "\n");
    for (const char* name : {"plan.tsv", "plan_patients.tsv", "plan.json"})
        make_read_only(folder / name);
}

PlanFile::PlanFile(const fs::path& folder) : folder_(folder) {
    if (!fs::exists(folder / "plan.json")) refuse_plan(folder, "there is no plan.json in it");
    const std::string places = text_of_file(folder / "plan_patients.tsv");
    try {
        const auto json = nlohmann::ordered_json::parse(text_of_file(folder / "plan.json"));
        if (json.at("format") != plan_format || json.at("format_version") != plan_format_version)
            refuse_plan(folder, "plan.json is of another version of palpate");
        if (json.at("plan_patients_sha256") != sha256_of(places))
            refuse_plan(folder, "plan_patients.tsv is not the one that plan.json belongs to");
        head_ = head_of(json);
    } catch (const nlohmann::ordered_json::exception&) {
        refuse_plan(folder, "plan.json is damaged");
    }
    const DelimitedText table = parse_delimited(places, {'\t'});
    if (!table.faults.empty() || table.columns != patients_columns)
        refuse_plan(folder, "plan_patients.tsv is damaged");
    places_.reserve(table.rows.size());
    for (const auto& row : table.rows)
        places_.push_back({row[0], row[5], std::stoull(row[1]), std::stoull(row[2]),
                           std::stoull(row[3]), std::stod(row[4])});
    file_ = ::open((folder / "plan.tsv").c_str(), O_RDONLY | O_CLOEXEC);
    if (file_ < 0) refuse_plan(folder, "plan.tsv cannot be read");
}

PlanFile::~PlanFile() { ::close(file_); }

std::size_t PlanFile::num_cases() const {
    return std::accumulate(places_.begin(), places_.end(), std::size_t{0},
                           [](std::size_t sum, const Place& place) { return sum + place.cases; });
}

std::vector<double> PlanFile::estimates_s() const {
    std::vector<double> estimates;
    for (const Place& place : places_) estimates.push_back(place.estimate_s);
    return estimates;
}

std::string PlanFile::rows_of(const Place& place) const {
    std::string rows(place.bytes, '\0');
    std::size_t got = 0;
    while (got < rows.size()) {
        const ssize_t more = ::pread(file_, rows.data() + got, rows.size() - got,
                                     static_cast<off_t>(place.begin + got));
        if (more < 0 && errno == EINTR) continue;
        if (more <= 0) break;
        got += static_cast<std::size_t>(more);
    }
    if (got < rows.size() || !sha256_of(rows).starts_with(place.sha256))
        refuse_plan(folder_, "plan.tsv is not the one that plan.json belongs to");
    return rows;
}

CohortPatient PlanFile::patient(std::size_t position) const {
    CohortPatient patient;
    const DelimitedFormat format{'\t', false, true};
    for_each_row(rows_of(places_.at(position)), format, [&](RawRow& row) {
        if (row.cells.size() != num_plan_columns) refuse_plan(folder_, "plan.tsv is damaged");
        auto& cell = row.cells;
        if (patient.cases.empty()) {
            patient.id = cell[column_patient];
            patient.participant_id = cell[column_participant];
            patient.reference_name = cell[column_reference];
            patient.reference = cell[column_reference_file];
            patient.reference_sha256 = cell[column_reference_sha256];
            patient.config = cell[column_config];
            patient.align = cell[column_align];
            patient.initial_transform = cell[column_transform];
            patient.estimate_s = places_[position].estimate_s;
        }
        patient.cases.push_back({std::move(cell[column_case]), std::move(cell[column_target]),
                                 std::move(cell[column_session]),
                                 std::move(cell[column_target_file]),
                                 std::move(cell[column_target_sha256]), std::move(cell[column_key]),
                                 std::move(cell[column_exclude])});
    });
    return patient;
}

CohortPatient PlanFile::patient(const std::string& id) const {
    const auto found = std::find_if(places_.begin(), places_.end(),
                                    [&](const Place& place) { return place.id == id; });
    if (found == places_.end())
        throw Error(ErrorCode::invalid_argument, fmt::format("the plan has no patient '{}'", id));
    return patient(static_cast<std::size_t>(found - places_.begin()));
}

CohortPlan read_plan(const fs::path& folder) {
    const PlanFile file(folder);
    CohortPlan plan{file.head()};
    for (std::size_t k = 0; k < file.num_patients(); ++k) plan.patients.push_back(file.patient(k));
    return plan;
}

}  // namespace palpate
