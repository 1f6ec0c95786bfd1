// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/make_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <map>
#include <set>

#include "host/apps/recover/modelling/settings.hpp"
#include "host/cohort/content_key.hpp"
#include "host/cohort/engine_files.hpp"
#include "host/cohort/input_check.hpp"
#include "host/cohort/plan_file.hpp"
#include "host/cohort/plan_rows.hpp"
#include "host/cohort/recover_choice.hpp"
#include "host/io/option.hpp"
#include "host/io/output_folder.hpp"
#include "host/io/settings_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr const char* problems_name = "problems.tsv";

/// Bytes (in whole blocks of 4 KiB) and inodes of a case with its share of what a patient has.
struct Budget {
    double bytes, inodes;
};
constexpr Budget budgets[] = {{35e3, 5}, {300e3, 8}, {120e6, 14}};  // table, compact, all
constexpr double spare = 1.2;                                       // room that is kept

void take_config(const fs::path& path, CohortPlan& plan, fs::path& settings, fs::path& root) {
    const std::string name = path.filename().string();
    const SettingsTable config = SettingsTable::parse(text_of_file(path), name);
    config.allow_keys({"plan", "recover", "limits", "slurm"});
    const auto beside = [&](const std::string& file) { return path.parent_path() / file; };
    if (const auto part = config.table("plan")) {
        part->allow_keys({"root", "settings", "keep", "shard_minutes"});
        if (const auto text = part->text("root"); text && root.empty()) root = beside(*text);
        if (const auto text = part->text("settings"); text && settings.empty())
            settings = beside(*text);
        if (const auto word = part->choice("keep", {"table", "compact", "all"}))
            plan.keep = kept_files_of(*word);
        plan.shard_minutes =
            part->number("shard_minutes", {0.1, 10080}).value_or(plan.shard_minutes);
    }
    if (const auto part = config.table("limits")) {
        part->allow_keys({"target_seconds", "attempts", "memory_mb"});
        plan.limits.target_s = part->number("target_seconds", {0.1, 1e7}).value_or(0);
        plan.limits.attempts =
            part->whole_number("attempts", 1, 100).value_or(plan.limits.attempts);
        plan.limits.memory_mb =
            part->number("memory_mb", {10, 1e7}).value_or(plan.limits.memory_mb);
    }
    if (const auto part = config.table("recover")) {
        const std::vector<Option> table = cohort_recover_table();
        for (const std::string& key : part->keys()) {
            if (!find_option(table, key))
                part->refuse(key, "allowed: options of `palpate recover` that hold for all cases");
            plan.recover_toml += key + " = " + setting_text(*part->value(key)) + "\n";
        }
    }
    if (const auto part = config.table("slurm")) {
        part->allow_keys({"lines"});
        if (const auto lines = part->value("lines")) {
            const auto* texts = std::get_if<std::vector<std::string>>(&*lines);
            if (!texts) part->refuse("lines", "allowed: a list of texts");
            plan.slurm_lines = *texts;
        }
    }
}

/// The work of one call of `make_cohort_plan`.
class Planner {
public:
    Planner(const PlanRequest& request, const fs::path& hashes, const ProgressSink& progress)
        : request_(request), files_(hashes, request.check_voxels), progress_(progress) {}

    PlannedCohort plan() {
        fs::path root = request_.root, settings = request_.settings;
        if (!request_.config.empty()) take_config(request_.config, out_.plan, settings, root);
        if (request_.keep) out_.plan.keep = *request_.keep;
        out_.plan.test_stub_s = request_.test_stub_s;
        recover_values(out_.plan.recover_toml);  // refuses what is not allowed
        const bool is_csv = has_ending(request_.table, ".csv");
        if (!is_csv && !has_ending(request_.table, ".tsv"))
            throw Error(ErrorCode::input_unreadable,
                        fmt::format("{}: its name ends neither in .tsv nor in .csv",
                                    request_.table.string()));
        take_rows({is_csv ? ',' : '\t'}, settings, root);
        name_and_hash();
        std::stable_sort(out_.faults.begin(), out_.faults.end(),
                         [](const auto& a, const auto& b) { return a.line < b.line; });
        std::set<std::size_t> bad;
        for (const TableFault& fault : out_.faults) bad.insert(fault.line);
        out_.plan.num_bad_rows = bad.size();
        return std::move(out_);
    }

    const FileChecks& files() const { return files_; }

private:
    /// The text of the table is gone afterwards.
    void take_rows(const DelimitedFormat& format, const fs::path& settings, const fs::path& root) {
        const std::string text = text_of_file(request_.table);
        const double lines = 1 + double(std::count(text.begin(), text.end(), '\n'));
        const fs::path beside = fs::absolute(request_.table).parent_path();
        const std::vector<TableFault> of_form = for_each_plan_row(
            text, format, root.empty() ? beside : fs::absolute(root),
            [&](const PlanRequestRow& row) {
                report_progress(progress_, "checking", double(row.line) / lines,
                                fmt::format("line {} of {:.0f}", row.line, lines));
                take(row, settings, beside);
            });
        out_.faults.insert(out_.faults.end(), of_form.begin(), of_form.end());
    }

    void refuse(const PlanRequestRow& row, const char* column, const std::string& why) {
        out_.faults.push_back({row.line, column, why});
        is_good_ = false;
    }

    /// A sentence that names the file once.
    static std::string told(const std::string& path, const std::string& fault) {
        return fault.find(path) == std::string::npos ? fmt::format("{}: {}", path, fault) : fault;
    }

    /// Empty hash: it is refused.
    std::string checked_volume(const PlanRequestRow& row, const char* column,
                               const std::string& path, const std::vector<int>& wanted) {
        const FileFacts facts = files_.volume(path);
        if (!facts.fault.empty()) refuse(row, column, told(path, facts.fault));
        const std::vector<int> missing = files_.missing_labels(path, wanted);
        if (!missing.empty())
            refuse(row, column,
                   fmt::format("{}: no voxel has label {}, which the settings name; check the "
                               "labels, or take that organ out",
                               path, fmt::join(missing, ", ")));
        return facts.sha256;
    }

    /// The name in `settings` of the organs of a row; parsed once.
    std::string config_of(const PlanRequestRow& row, const fs::path& usual,
                          const fs::path& beside) {
        const fs::path file = row.config.empty() ? usual : beside / row.config;
        if (file.empty()) {
            refuse(row, "config", "the row names no settings of organs; give --settings or a cell");
            return "";
        }
        const auto [found, is_new] = configs_.try_emplace(file.string());
        if (is_new) {
            try {
                const Settings organs = read_settings(file);
                const std::string toml = to_toml(organs);
                std::string stem = file.stem().string();
                if (!is_cohort_id(stem)) stem = "organs";
                found->second.first = fmt::format("{}-{}", stem, sha256_of(toml).substr(0, 8));
                const std::string& config = found->second.first;
                for (const auto& organ : organs.organs) {
                    const int label = static_cast<int>(organ.label);
                    labels_[config].of_reference.push_back(label);
                    if (organ.role != Role::fixed) labels_[config].of_target.push_back(label);
                }
                const bool is_known =
                    std::any_of(out_.settings.begin(), out_.settings.end(),
                                [&](const auto& known) { return known.first == config; });
                if (!is_known) out_.settings.emplace_back(config, toml);
            } catch (const Error& error) {
                found->second.second = error.what();
            }
        }
        if (!found->second.second.empty()) refuse(row, "config", found->second.second);
        return found->second.first;
    }

    void take(const PlanRequestRow& row, const fs::path& usual_settings, const fs::path& beside) {
        is_good_ = true;
        const std::string config = config_of(row, usual_settings, beside);
        if (row.exclude.empty()) {
            const std::string reference =
                checked_volume(row, "reference", row.reference, labels_[config].of_reference);
            const std::string target =
                checked_volume(row, "target", row.target, labels_[config].of_target);
            if (!row.initial_transform.empty()) {
                const FileFacts facts = files_.plain_file(row.initial_transform);
                if (!facts.fault.empty())
                    refuse(row, "initial_transform",
                           fmt::format("{}: {}", row.initial_transform, facts.fault));
            }
            if (is_good_ && reference == target)
                refuse(row, "target", "it holds the same bytes as the reference");
        }
        if (is_good_) add(row, config);
    }

    void add(const PlanRequestRow& row, const std::string& config) {
        const std::string& transform = row.initial_transform;
        const std::string unit = row.participant_id + '\n' + row.reference + '\n' + config + '\n' +
                                 row.align + '\n' + transform;
        const auto [found, is_new] = units_.try_emplace(unit, out_.plan.patients.size());
        if (is_new) {
            CohortPatient patient;
            patient.participant_id = row.participant_id;
            patient.reference = row.reference;
            patient.config = config;
            patient.align = row.align;
            patient.initial_transform = row.initial_transform;
            out_.plan.patients.push_back(std::move(patient));
        }
        CohortCase c;
        c.id = row.case_id;
        c.session_id = row.session_id;
        c.target = row.target;
        c.excluded = row.exclude;
        out_.plan.patients[found->second].cases.push_back(std::move(c));
    }

    void name_and_hash() {
        std::map<std::string, int> references;  // of each participant
        for (CohortPatient& patient : out_.plan.patients) {
            const int number = ++references[patient.participant_id];
            patient.reference_name = fmt::format("ref-{:02}", number);
            patient.id = patient.participant_id;
            if (number > 1) patient.id += "_" + patient.reference_name;
            patient.cases.shrink_to_fit();  // of a million cases the spare room is 100 MB
            name_cases(patient);
            hash(patient);
        }
    }

    static void name_cases(CohortPatient& patient) {
        std::set<std::string> given;
        for (const CohortCase& c : patient.cases) given.insert(c.id);
        for (std::size_t k = 0; k < patient.cases.size(); ++k) {
            CohortCase& c = patient.cases[k];
            c.target_name = fmt::format("target-{:02}", k + 1);
            if (!c.id.empty()) continue;
            c.id = c.target_name;
            while (given.count(c.id)) c.id += "-x";  // somebody named another case so
        }
    }

    const CaseKeys& keys_of(const CohortPatient& patient) {
        const auto name = std::pair{patient.config, patient.align};
        if (const auto found = keys_.find(name); found != keys_.end()) return found->second;
        KeyParts parts;
        parts.is_test_stub = request_.test_stub_s.has_value();
        for (const auto& [config, toml] : out_.settings)
            if (config == patient.config) parts.settings_toml = toml;
        parts.options = options_of_the_key(recover_values(out_.plan.recover_toml, patient.align));
        return keys_.emplace(name, CaseKeys(parts)).first->second;
    }

    void hash(CohortPatient& patient) {
        const CaseKeys& keys = keys_of(patient);
        const std::string transform = patient.initial_transform.empty()
                                          ? ""
                                          : files_.plain_file(patient.initial_transform).sha256;
        std::size_t targets = 0;
        for (CohortCase& c : patient.cases) {
            if (!c.excluded.empty()) continue;
            ++targets;
            if (patient.reference_sha256.empty())
                patient.reference_sha256 = files_.volume(patient.reference).sha256;
            c.target_sha256 = files_.volume(c.target).sha256;
            c.key = keys.key(patient.reference_sha256, c.target_sha256, transform);
        }
        patient.estimate_s = reference_estimate_s + target_estimate_s * double(targets);
    }

    const PlanRequest& request_;
    FileChecks files_;
    const ProgressSink& progress_;
    PlannedCohort out_;
    bool is_good_ = true;                                           ///< the row in hand
    std::map<std::pair<std::string, std::string>, CaseKeys> keys_;  ///< by config and align
    /// Labels that volumes must have; fixed organs are not looked for in targets.
    struct Labels {
        std::vector<int> of_reference, of_target;
    };
    std::map<std::string, Labels> labels_;  ///< by config
    /// By file: name in `settings`, or what is wrong.
    std::map<std::string, std::pair<std::string, std::string>> configs_;
    std::map<std::string, std::size_t> units_;
};

void check_room(const CohortPlan& plan, const fs::path& folder) {
    struct statvfs disk {};
    if (::statvfs(folder.c_str(), &disk) != 0) return;
    const Budget& each = budgets[static_cast<std::size_t>(plan.keep)];
    const double cases = double(plan.num_cases()), bytes = spare * cases * each.bytes;
    const double free_bytes = double(disk.f_bavail) * double(disk.f_frsize);
    if (bytes > free_bytes)
        throw Error(ErrorCode::output_failed,
                    fmt::format("{}: {} cases kept as '{}' need about {:.1f} GB, and {:.1f} GB are "
                                "free; keep less (--keep), or choose another folder",
                                folder.string(), plan.num_cases(), name_of(plan.keep), bytes / 1e9,
                                free_bytes / 1e9));
    const double inodes = spare * cases * each.inodes;
    if (disk.f_files > 0 && inodes > double(disk.f_favail))
        throw Error(
            ErrorCode::output_failed,
            fmt::format("{}: {} cases need about {:.0f} files, and the file system has room "
                        "for {}; keep less (--keep), or choose another folder",
                        folder.string(), plan.num_cases(), inodes, disk.f_favail));
}

}  // namespace

PlannedCohort make_cohort_plan(const PlanRequest& request, const fs::path& hashes,
                               const ProgressSink& progress) {
    Planner planner(request, hashes, progress);
    PlannedCohort planned = planner.plan();
    make_folders(hashes.parent_path());
    planner.files().write();
    return planned;
}

void check_cohort_folder(const fs::path& folder, bool overwrite) {
    if (!fs::exists(folder)) return;
    const bool has_plan = fs::exists(folder / "plan.json");
    if (has_plan && !overwrite)
        throw Error(
            ErrorCode::output_failed,
            fmt::format("{} has a plan already; add --overwrite to replace the plan (results "
                        "stay, and count where their key is the same), or choose another --out",
                        folder.string()));
    if (!has_plan && !fs::exists(folder / problems_name) &&
        (!fs::is_directory(folder) || !fs::is_empty(folder)))
        throw Error(
            ErrorCode::output_failed,
            fmt::format("{} holds files but no cohort; choose another --out", folder.string()));
}

void write_planned(const PlannedCohort& planned, const fs::path& folder, bool skip_bad) {
    make_folders(folder / "settings");
    std::string text = delimited_line({"row", "column", "problem"}, '\t');
    for (const TableFault& fault : planned.faults)
        text += delimited_line(
            {fault.line > 0 ? fmt::to_string(fault.line) : "", fault.column, fault.sentence}, '\t');
    replace_text(folder / problems_name, text);
    const std::size_t bad = planned.faults.size();
    if (bad > 0 && (!skip_bad || planned.plan.num_cases() == 0))
        throw Error(
            ErrorCode::input_unusable,
            fmt::format("{} problem{} in {} row{} of the table, listed in {}; the first: {}; "
                        "mend them, or leave these rows out with --skip-bad",
                        bad, bad == 1 ? "" : "s", planned.plan.num_bad_rows,
                        planned.plan.num_bad_rows == 1 ? "" : "s",
                        (folder / problems_name).string(),
                        fmt::format("line {}, {}: {}", planned.faults[0].line,
                                    planned.faults[0].column, planned.faults[0].sentence)));
    check_room(planned.plan, folder);
    for (const auto& [name, toml] : planned.settings)
        replace_text(folder / "settings" / (name + ".toml"), toml);
    write_plan(planned.plan, folder);
    write_engine_files(planned.plan, folder / "engines");
}

}  // namespace palpate
