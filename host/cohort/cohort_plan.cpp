// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/cohort_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "host/cohort/content_key.hpp"
#include "host/io/delimited_text.hpp"
#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 3> words_of_kept{"table", "compact", "all"};
constexpr const char* plan_format = "palpate-cohort-plan";
constexpr double shortest_limit_s = 60, limit_factor = 10;

const std::vector<std::string> plan_columns = {
    "patient",          "participant_id", "reference",  "target",         "session_id",
    "case_id",          "config",         "align",      "exclude",        "key",
    "reference_sha256", "target_sha256",  "estimate_s", "reference_file", "target_file",
    "initial_transform"};

std::string plan_table_of(const CohortPlan& plan) {
    std::string text = delimited_line(plan_columns, '\t');
    for (const CohortPatient& p : plan.patients)
        for (const CohortCase& c : p.cases)
            text += delimited_line(
                {p.id, p.participant_id, p.reference_name, c.target_name, c.session_id, c.id,
                 p.config, p.align, c.excluded, c.key, p.reference_sha256, c.target_sha256,
                 fmt::format("{:.1f}", p.estimate_s), p.reference.string(), c.target.string(),
                 p.initial_transform.string()},
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

void take_rows(const DelimitedText& table, CohortPlan& plan) {
    std::map<std::string, std::size_t> position;
    for (const auto& row : table.rows) {
        const auto cell = [&](const char* name) { return row[*table.find(name)]; };
        const auto [found, is_new] = position.try_emplace(cell("patient"), plan.patients.size());
        if (is_new)
            plan.patients.push_back({cell("patient"), cell("participant_id"), cell("reference"),
                                     cell("reference_file"), cell("reference_sha256"),
                                     cell("config"), cell("align"), cell("initial_transform"),
                                     std::stod(cell("estimate_s"))});
        plan.patients[found->second].cases.push_back(
            {cell("case_id"), cell("target"), cell("session_id"), cell("target_file"),
             cell("target_sha256"), cell("key"), cell("exclude")});
    }
}

}  // namespace

const char* name_of(KeptFiles keep) { return words_of_kept.at(static_cast<std::size_t>(keep)); }

KeptFiles kept_files_of(std::string_view word) {
    for (std::size_t k = 0; k < words_of_kept.size(); ++k)
        if (word == words_of_kept[k]) return static_cast<KeptFiles>(k);
    throw Error(ErrorCode::invalid_argument,
                fmt::format("keep is \"{}\"; allowed: table, compact, all", word));
}

std::size_t CohortPlan::num_cases() const {
    std::size_t sum = 0;
    for (const CohortPatient& p : patients)
        sum += static_cast<std::size_t>(std::count_if(
            p.cases.begin(), p.cases.end(), [](const auto& c) { return c.excluded.empty(); }));
    return sum;
}

const CohortPatient& CohortPlan::patient(const std::string& id) const {
    for (const CohortPatient& p : patients)
        if (p.id == id) return p;
    throw Error(ErrorCode::invalid_argument, fmt::format("the plan has no patient '{}'", id));
}

double limit_s(const CohortPlan& plan) {
    if (plan.limits.target_s > 0) return plan.limits.target_s;
    return std::max(shortest_limit_s, limit_factor * reference_estimate_s);
}

void replace_text(const fs::path& path, const std::string& text) {
    write_atomically(path, [&](const fs::path& temporary) { write_text_file(temporary, text); });
}

std::string text_of_file(const fs::path& path) {
    if (const auto why = why_unreadable(path))
        throw Error(ErrorCode::input_unreadable, path.string() + ": " + *why);
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write_plan(const CohortPlan& plan, const fs::path& folder) {
    const std::string table = plan_table_of(plan);
    Json json{{"format", plan_format},
              {"format_version", 1},
              {"version", version_text()},
              {"numerics_version", numerics_version},
              {"patients", plan.patients.size()},
              {"cases", plan.num_cases()},
              {"bad_rows_left_out", plan.num_bad_rows},
              {"keep", name_of(plan.keep)},
              {"shard_minutes", plan.shard_minutes},
              {"recover", plan.recover_toml},
              {"limits", {{"target_s", plan.limits.target_s}, {"attempts", plan.limits.attempts}}},
              {"slurm", plan.slurm_lines},
              {"plan_tsv_sha256", sha256_of(table)}};
    if (plan.test_stub_s) json["test_stub_s"] = *plan.test_stub_s;
    for (const char* name : {"cases", "failed", "journal", "logs", "engines"})
        make_folders(folder / name);
    replace_text(folder / "plan.tsv", table);
    replace_text(folder / "plan.json", json.dump(2) + "\n");
    for (const char* name : {"plan.tsv", "plan.json"}) make_read_only(folder / name);
}

CohortPlan read_plan(const fs::path& folder) {
    if (!fs::exists(folder / "plan.json")) refuse_plan(folder, "there is no plan.json in it");
    const std::string table_text = text_of_file(folder / "plan.tsv");
    CohortPlan plan;
    try {
        const Json json = Json::parse(text_of_file(folder / "plan.json"));
        if (json.at("format") != plan_format || json.at("format_version") != 1)
            refuse_plan(folder, "plan.json is of another version of palpate");
        if (json.at("plan_tsv_sha256") != sha256_of(table_text))
            refuse_plan(folder, "plan.tsv is not the one that plan.json belongs to");
        plan.keep = kept_files_of(json.at("keep").get<std::string>());
        plan.recover_toml = json.at("recover");
        plan.shard_minutes = json.at("shard_minutes");
        plan.limits = {json.at("limits").at("target_s"), json.at("limits").at("attempts")};
        plan.slurm_lines = json.at("slurm");
        plan.num_bad_rows = json.at("bad_rows_left_out");
        if (json.contains("test_stub_s")) plan.test_stub_s = json["test_stub_s"].get<double>();
    } catch (const Json::exception&) {
        refuse_plan(folder, "plan.json is damaged");
    }
    const DelimitedText table = parse_delimited(table_text, {'\t'});
    if (!table.faults.empty() || table.columns != plan_columns)
        refuse_plan(folder, "plan.tsv is damaged");
    take_rows(table, plan);
    return plan;
}

}  // namespace palpate
