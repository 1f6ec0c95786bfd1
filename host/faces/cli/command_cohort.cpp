// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>

#include "host/cohort/collect.hpp"
#include "host/cohort/expand.hpp"
#include "host/cohort/make_plan.hpp"
#include "host/cohort/patient.hpp"
#include "host/cohort/run_cohort.hpp"
#include "host/cohort/tiny_phantom.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/console.hpp"
#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr const char* hidden = "";

struct PlanArguments {
    std::string table, out, config, settings, root, keep, check = "header";
    bool skip_bad = false, overwrite = false, quiet = false;
    double test_stub_s = -1;
};

struct RunArguments {
    std::string cohort, shard = "1/1", progress = "bar";
    int jobs = 1;
    std::vector<std::string> only;
    bool retry_failed = false, keep_going = false;
};

int plan_cohort(const PlanArguments& a) {
    PlanRequest request;
    request.table = a.table;
    request.config = a.config;
    request.settings = a.settings;
    request.root = a.root;
    if (!a.keep.empty()) request.keep = kept_files_of(a.keep);
    request.check_voxels = a.check == "voxels";
    if (a.test_stub_s >= 0) request.test_stub_s = a.test_stub_s;
    const std::filesystem::path folder = a.out;
    check_cohort_folder(folder, a.overwrite);
    will_write(folder / "any");
    const PlannedCohort planned =
        make_cohort_plan(request, folder / "hashes.tsv", console_progress(a.quiet));
    end_progress_line();
    write_planned(planned, folder, a.skip_bad);
    double seconds = 0;
    for (const CohortPatient& patient : planned.plan.patients) seconds += patient.estimate_s;
    const auto counted = [](std::size_t count, std::string_view what) {
        return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
    };
    fmt::print("{} of {}, about {:.2g} core hours, kept as '{}'\n",
               counted(planned.plan.num_cases(), "pair"),
               counted(planned.plan.patients.size(), "patient"), seconds / 3600,
               name_of(planned.plan.keep));
    if (planned.plan.num_bad_rows > 0)
        fmt::print("{} bad rows are left out: {}\n", planned.plan.num_bad_rows,
                   (folder / "problems.tsv").string());
    fmt::print("next: palpate cohort run {}\n", a.out);
    return 0;
}

void add_plan(CLI::App& app, Run& run) {
    auto a = std::make_shared<PlanArguments>();
    CLI::App* command = app.add_subcommand("plan", "Check a table of pairs and plan the work");
    command
        ->add_option("table", a->table,
                     "Table of pairs (.tsv .csv): participant_id reference target ...")
        ->required()
        ->type_name("FILE");
    command->add_option("--out", a->out, "Folder of the cohort, made new")
        ->required()
        ->type_name("FOLDER");
    command->add_option("--config", a->config, "cohort.toml: plan, options of recover, limits")
        ->type_name("FILE");
    command->add_option("--settings", a->settings, "Organs (TOML) of rows that name none")
        ->type_name("FILE");
    command->add_option("--root", a->root, "Where relative paths begin; default: at the table")
        ->type_name("FOLDER");
    command
        ->add_option("--keep", a->keep,
                     "What is kept of a case: table (result.json), compact (and nodal motion "
                     "and forces), all; default: compact")
        ->check(CLI::IsMember({"table", "compact", "all"}));
    command->add_option("--check", a->check, "How volumes are checked: header, or all voxels")
        ->check(CLI::IsMember({"header", "voxels"}))
        ->capture_default_str();
    command->add_flag("--skip-bad", a->skip_bad, "Leave out rows with problems");
    command->add_flag("--overwrite", a->overwrite, "Replace an older plan; results stay");
    command->add_flag("--quiet", a->quiet, "No progress");
    command
        ->add_option("--test-stub", a->test_stub_s,
                     "For tests: compute nothing, sleep so many seconds a case")
        ->group(hidden);
    command->callback([a, &run] { run = [a] { return plan_cohort(*a); }; });
}

int run_whole(const RunArguments& a) {
    CohortRunOptions options;
    options.folder = a.cohort;
    options.program = std::filesystem::read_symlink("/proc/self/exe");
    options.shard = shard_of(a.shard, [](const char* name) { return std::getenv(name); });
    options.jobs = a.jobs;
    options.only = a.only;
    options.retry_failed = a.retry_failed;
    options.keep_going = a.keep_going;
    if (a.progress == "json")
        options.tell_case = [](const std::string& line) {
            fmt::print("{}", line);
            std::fflush(stdout);
        };
    ::setenv("OPENBLAS_NUM_THREADS", "1", 0);  // one patient a core
    ::setenv("POCL_MAX_PTHREAD_COUNT", "1", 0);
    // Of glibc, for the processes of patients: what is freed goes back at once, 20 % less at the
    // peak.
    ::setenv("MALLOC_ARENA_MAX", "2", 0);
    ::setenv("MALLOC_MMAP_THRESHOLD_", "2097152", 0);
    ::setenv("MALLOC_TRIM_THRESHOLD_", "33554432", 0);
    const CohortRun done = run_cohort(options, console_progress(a.progress != "bar"));
    end_progress_line();
    if (a.progress != "json")
        fmt::print("{} of {} cases done, {} not converged, {} failed\n",
                   done.done + done.not_converged, done.num_cases, done.not_converged, done.failed);
    return done.exit_code;
}

void add_run(CLI::App& app, Run& run) {
    auto a = std::make_shared<RunArguments>();
    CLI::App* command =
        app.add_subcommand("run", "Do what is missing; again after anything went wrong");
    command->add_option("cohort", a->cohort, "Its folder")->required()->type_name("FOLDER");
    command->add_option("--shard", a->shard, "Part K of N, K/N, or auto: of the array job")
        ->capture_default_str();
    command->add_option("--jobs", a->jobs, "Patients at a time, a core each")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    command->add_option("--only", a->only, "These participants, not all")->type_name("ID");
    command->add_flag("--retry-failed", a->retry_failed, "Also cases that failed for good");
    command->add_flag("--keep-going", a->keep_going,
                      "Even if 20 cases fail alike before one works");
    command->add_option("--progress", a->progress, "bar, json (a line a case) or none")
        ->check(CLI::IsMember({"bar", "json", "none"}))
        ->capture_default_str();
    command->callback([a, &run] { run = [a] { return run_whole(*a); }; });
}

/// A process of a run, for one patient: events on standard output.
int run_one(const PatientJob& job) {
    const auto tell = [](const PatientEvent& event) {
        const std::string line = event_line(event);
        if (::write(STDOUT_FILENO, line.data(), line.size()) != ssize_t(line.size()))
            throw Error(ErrorCode::cancelled, "the runner is gone");
    };
    const PlanFile plan(job.cohort);
    if (plan.head().test_stub_s) return run_stub_patient(plan, job, tell);
    return run_patient(job, tell, console_progress(false));
}

void add_patient(CLI::App& app, Run& run) {
    auto job = std::make_shared<PatientJob>();
    CLI::App* command = app.add_subcommand("patient", "A process of a run")->group(hidden);
    command->add_option("cohort", job->cohort)->required();
    command->add_option("patient", job->patient)->required();
    command->add_option("--only", job->cases)->expected(1, 100000);
    command->add_flag("--on-reference-backend", job->on_reference_backend);
    command->callback([job, &run] { run = [job] { return run_one(*job); }; });
}

void add_trial(CLI::App& app, Run& run) {
    auto folder = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("trial", "Whether this machine works")->group(hidden);
    command->add_option("cohort", *folder)->required();
    command->callback([folder, &run] {
        run = [folder] {
            recover_tiny_phantom(*folder, console_progress(true));
            return 0;
        };
    });
}

void add_status(CLI::App& app, Run& run) {
    auto folder = std::make_shared<std::string>();
    auto as_json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("status", "Count what is done; exit code 9: not all");
    command->add_option("cohort", *folder, "Its folder")->required()->type_name("FOLDER");
    command->add_flag("--json", *as_json, "For programs");
    command->callback([folder, as_json, &run] {
        run = [folder, as_json] {
            const CohortStatus status = cohort_status(*folder);
            fmt::print("{}", *as_json ? status_json(status) : status_text(status));
            return status.exit_code();
        };
    });
}

void add_collect(CLI::App& app, Run& run) {
    auto folder = std::make_shared<std::string>();
    auto mixed = std::make_shared<bool>(false);
    auto ratings = std::make_shared<std::string>();
    CLI::App* command =
        app.add_subcommand("collect", "Write pairs.tsv, patients.tsv, index.html, gallery.html");
    command->add_option("cohort", *folder, "Its folder")->required()->type_name("FOLDER");
    command->add_flag("--mixed", *mixed, "Also results of other settings or inputs");
    command
        ->add_option("--ratings", *ratings,
                     "What a person said of cases in the gallery; default: COHORT/ratings.tsv")
        ->type_name("FILE");
    command->callback([folder, mixed, ratings, &run] {
        run = [folder, mixed, ratings] {
            const CollectedCohort collected =
                collect_cohort({*folder, *mixed, *ratings}, console_progress(false));
            end_progress_line();
            fmt::print(
                "{}page: {}/index.html, gallery: {}/gallery.html, tables: {}/pairs.tsv, "
                "{}/patients.tsv\n",
                status_text(collected.status), *folder, *folder, *folder, *folder);
            if (collected.unused_ratings > 0)
                fmt::print("{} ratings are of results that are no longer there, and not used\n",
                           collected.unused_ratings);
            return 0;
        };
    });
}

struct ExpandArguments {
    std::string cohort, out;
    std::vector<std::string> cases;
    bool quiet = false;
};

void add_expand(CLI::App& app, Run& run) {
    auto a = std::make_shared<ExpandArguments>();
    CLI::App* command =
        app.add_subcommand("expand", "Make whole result folders of cases kept as compact");
    command->add_option("cohort", a->cohort, "Its folder")->required()->type_name("FOLDER");
    command
        ->add_option("cases", a->cases,
                     "PATIENT/CASE as their folders are called; default: all with a result")
        ->type_name("CASE");
    command
        ->add_option("--out", a->out, "Gets a folder PATIENT/CASE each; default: COHORT/expanded")
        ->type_name("FOLDER");
    command->add_flag("--quiet", a->quiet, "No progress");
    command->callback([a, &run] {
        run = [a] {
            const std::filesystem::path out = a->out.empty()
                                                  ? std::filesystem::path(a->cohort) / "expanded"
                                                  : std::filesystem::path(a->out);
            const std::size_t made =
                expand_cases(a->cohort, a->cases, out, console_progress(a->quiet));
            end_progress_line();
            fmt::print("{} result folders made: {}\n", made, out.string());
            return 0;
        };
    });
}

}  // namespace

void add_cohort(CLI::App& app, Run& run) {
    CLI::App* command =
        app.add_subcommand("cohort", "Many patients: plan, run, status, collect, expand");
    command->require_subcommand(1);
    add_plan(*command, run);
    add_run(*command, run);
    add_patient(*command, run);
    add_trial(*command, run);
    add_status(*command, run);
    add_collect(*command, run);
    add_expand(*command, run);
}

}  // namespace palpate
