// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/run_cohort.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <deque>
#include <list>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>

#include "host/cohort/case_states.hpp"
#include "host/cohort/cohort_folder.hpp"
#include "host/cohort/machine_trial.hpp"
#include "host/cohort/patient.hpp"
#include "host/cohort/patient_events.hpp"
#include "host/cohort/patient_in_work.hpp"
#include "host/cohort/plan_file.hpp"
#include "host/cohort/shared_failure.hpp"
#include "host/io/output_folder.hpp"
#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

using Clock = PatientInWork::Clock;
constexpr int tick_ms = 100, most_device_failures = 3;  // of different patients in a row
constexpr double seconds_between_claims = 0.5, least_trial_s = 60, most_trial_s = 600;
constexpr double least_free_bytes = 64e6;

double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
}

/// The work of one call of `run_cohort`.
class CohortRunner {
public:
    CohortRunner(const CohortRunOptions& options, const ProgressSink& progress)
        : options_(options),
          progress_(progress),
          folder_(options.folder),
          plan_(options.folder),
          limit_s_(limit_s(plan_.head())),
          journal_(folder_),
          trial_(options.program, fs::absolute(options.folder),
                 std::clamp(limit_s_, least_trial_s, most_trial_s)) {
        // The journals are worth reading only by who needs most of them.
        std::optional<CaseStates> all;
        if (options.shard.count == 1) all.emplace(folder_);
        const std::vector<double> estimates = plan_.estimates_s();
        const auto shards = balanced_shards(estimates, options.shard.count);
        std::set<std::string> missing(options.only.begin(), options.only.end());
        for (const std::size_t k : shards[options.shard.number - 1]) {
            const CohortPatient patient = plan_.patient(k);
            if (!is_asked(patient)) continue;
            missing.erase(patient.participant_id);
            if (is_whole(patient, all)) continue;
            waiting_.push_back(k);
            left_s_ += estimates[k];
        }
        if (!missing.empty() && options.shard.count == 1)
            throw Error(
                ErrorCode::invalid_argument,
                fmt::format("--only {}: the plan has no such participant", *missing.begin()));
    }

    CohortRun run() {
        for (;;) {
            stop_if_interrupted();
            fill_slots();
            if (in_work_.empty() && waiting_.empty()) break;
            wait_for_news();
            try_machine();
            for (auto at = in_work_.begin(); at != in_work_.end();)
                at = is_over(*at) ? in_work_.erase(at) : std::next(at);
            report();
        }
        write_held_back();
        if (run_.failed + run_.not_converged > 0) run_.exit_code = exit_code_not_converged;
        return run_;
    }

private:
    bool is_asked(const CohortPatient& patient) const {
        return options_.only.empty() || std::find(options_.only.begin(), options_.only.end(),
                                                  patient.participant_id) != options_.only.end();
    }

    /// Counts the cases of a patient that are over; whether all are.
    bool is_whole(const CohortPatient& patient, const std::optional<CaseStates>& all) {
        std::vector<CaseState> states;
        if (all) {
            states = all->of(patient, false);
        } else {
            for (const CohortCase& c : patient.cases)
                states.push_back(folder_.state_of(patient, c));
        }
        bool is_whole = true;
        for (const CaseState& state : states) {
            run_.num_cases += state.status != CaseStatus::excluded;
            is_whole &= !is_to_do(state.status);
        }
        for (std::size_t c = 0; c < states.size(); ++c) {
            if (is_to_do(states[c].status)) continue;
            if (is_whole)
                add(states[c].status);  // nobody comes back to it
            else
                count(patient, patient.cases[c], states[c].status);
        }
        return is_whole;
    }

    bool is_to_do(CaseStatus status) const {
        return status == CaseStatus::waiting || status == CaseStatus::stale ||
               (status == CaseStatus::failed && options_.retry_failed);
    }

    /// Each case once, whoever did it.
    void count(const CohortPatient& patient, const CohortCase& c, CaseStatus status) {
        if (counted_.insert(patient.id + "/" + c.id).second) add(status);
    }

    void add(CaseStatus status) {
        run_.done += status == CaseStatus::done;
        run_.not_converged += status == CaseStatus::not_converged;
        run_.failed += status == CaseStatus::failed;
        if (run_.done + run_.not_converged > 0) shared_failure_.add_result();
    }

    std::size_t num_over() const { return run_.done + run_.not_converged + run_.failed; }

    void report() {
        std::string text = fmt::format("{} of {} cases", num_over(), run_.num_cases);
        if (run_.failed > 0) text += fmt::format(", {} failed", run_.failed);
        if (finished_s_ > 0) {  // by patients: their first pair takes longest
            const double left = left_s_ * seconds_since(begin_) / finished_s_;
            text += left < 90 ? fmt::format(", {:.0f} s left", left)
                              : fmt::format(", {:.0f} min left", left / 60);
        }
        report_progress(progress_, "running", double(num_over()) / double(run_.num_cases), text);
    }

    void stop_if_interrupted() {
        if (!is_interrupted()) return;
        stop_children();
        throw_if_interrupted();
    }

    /// In good order, within a second; what does not end is killed.
    void stop_children() {
        for (const PatientInWork& work : in_work_)
            if (work.child) work.child->signal_group(SIGTERM);
        trial_.stop();
        const auto begin = Clock::now();
        while (!in_work_.empty() && seconds_since(begin) < 0.8) {
            for (auto at = in_work_.begin(); at != in_work_.end();) {
                take_news(*at);
                const bool is_gone = !at->child || at->has_ended || at->child->ended();
                at = is_gone ? in_work_.erase(at) : std::next(at);
            }
            ::usleep(20000);
        }
        in_work_.clear();
    }

    [[noreturn]] void stop_with(ErrorCode code, const std::string& sentence) {
        stop_children();
        throw Error(code, sentence);
    }

    void check_room() {
        struct statvfs disk {};
        if (::statvfs(folder_.path().c_str(), &disk) != 0) return;
        const double cases = plan_.head().keep == KeptFiles::all ? 240e6 : 0;
        if (double(disk.f_bavail) * double(disk.f_frsize) < least_free_bytes + cases)
            stop_with(ErrorCode::output_failed,
                      fmt::format("{}: the disk is almost full; make room, and run again: what is "
                                  "done stays",
                                  folder_.path().string()));
    }

    void fill_slots() {
        for (PatientInWork& work : in_work_)
            if (!work.child) start(work);
        if (are_all_busy_ && seconds_since(last_claims_) < seconds_between_claims) return;
        const bool has_room = in_work_.size() < std::size_t(options_.jobs);
        are_all_busy_ = has_room && !waiting_.empty();
        last_claims_ = Clock::now();
        for (std::size_t tries = waiting_.size();
             tries > 0 && in_work_.size() < std::size_t(options_.jobs); --tries) {
            const std::size_t position = waiting_.front();
            waiting_.pop_front();
            if (!begin(position)) waiting_.push_back(position);  // somebody else works on it
        }
    }

    /// False if its claim is held elsewhere.
    bool begin(std::size_t position) {
        auto of_plan = std::make_unique<const CohortPatient>(plan_.patient(position));
        const CohortPatient& patient = *of_plan;
        folder_.make_place_of(patient);
        auto claim = Claim::take(folder_.claim_file(patient));
        if (!claim) return false;
        are_all_busy_ = false;
        std::vector<std::string> ids;
        for (const CohortCase& c : patient.cases) {
            const CaseStatus status = folder_.state_of(patient, c).status;
            if (status == CaseStatus::excluded) continue;
            if (is_to_do(status))
                ids.push_back(c.id);
            else
                count(patient, c, status);  // perhaps done elsewhere meanwhile
        }
        if (ids.empty()) {
            left_s_ -= patient.estimate_s;
            return true;
        }
        in_work_.push_back({std::move(of_plan), std::move(*claim),
                            PatientQueue(std::move(ids), plan_.head().limits.attempts)});
        start(in_work_.back());
        return true;
    }

    void start(PatientInWork& work) {
        check_room();
        const NextWork next = work.queue.next();
        std::vector<std::string> words{"cohort", "patient", fs::absolute(folder_.path()).string(),
                                       work.patient->id, "--only"};
        words.insert(words.end(), next.cases.begin(), next.cases.end());
        if (next.on_reference_backend) words.push_back("--on-reference-backend");
        work.begin_watch(limit_s_ * next.limit_factor, next.cases);
        work.child =
            std::make_unique<SupervisedChild>(options_.program, words, work.claim.descriptor());
        ++run_.started_here;
    }

    void wait_for_news() {
        std::vector<pollfd> ends;
        for (const PatientInWork& work : in_work_)
            for (const int end : {work.child->output(), work.child->errors()})
                if (end >= 0 && !work.has_ended) ends.push_back({end, POLLIN, 0});
        ::poll(ends.data(), ends.size(), tick_ms);
    }

    void take_news(PatientInWork& work) {
        if (!work.child) return;
        work.child->read([&](const std::string& line) {
            if (const auto event = event_of(line)) take(work, *event);
        });
    }

    void take(PatientInWork& work, const PatientEvent& event) {
        using Kind = PatientEvent::Kind;
        work.last_event = Clock::now();
        if (event.kind == Kind::started) work.current = event.case_id;
        if (event.kind == Kind::done && event.record) note_done(work, *event.record);
        if (event.kind == Kind::patient_failed) work.unreported.clear();
        work.unreported.erase(event.kind == Kind::started ? "" : event.case_id);
        if (event.kind == Kind::failed || event.kind == Kind::patient_failed)
            note_event(work, event);
    }

    void note_done(PatientInWork& work, const CaseRecord& record) {
        for (const CohortCase& c : work.patient->cases) {
            if (c.id != record.case_id) continue;
            journal_.add(record, inode_of(folder_.case_folder(*work.patient, c)));
            std::error_code ignored;
            fs::remove(folder_.failure_file(*work.patient, c), ignored);
            count(*work.patient, c,
                  record.converged ? CaseStatus::done : CaseStatus::not_converged);
        }
        work.queue.done(record.case_id);
        work.current.clear();
        device_failures_ = 0;
        write_held_back();
        tell(*work.patient, record.case_id, record.converged ? 0 : exit_code_not_converged, "");
    }

    void note_event(PatientInWork& work, const PatientEvent& event) {
        if (event.code == exit_code_of(ErrorCode::output_failed))
            output_failure_ = event.sentence;
        else if (may_be_of_machine(event.code) || is_late(event))
            work.faults.push_back({event.case_id, event.code, event.sentence});
        else if (event.code != exit_code_of(ErrorCode::cancelled) || !is_interrupted())
            note_failure(work, event.case_id, event.code, event.sentence);
        if (event.case_id == work.current) work.current.clear();
    }

    /// Something that palpate waited for took too long: what hangs may be the machine.
    bool is_late(const PatientEvent& event) const {
        return event.code == exit_code_of(ErrorCode::time_limit) && !is_interrupted();
    }

    void note_failure(PatientInWork& work, const std::string& case_id, int code,
                      const std::string& sentence) {
        for (FinalFailure& failure : work.queue.failed(case_id, code, sentence)) {
            if (code == exit_code_of(ErrorCode::device_failed)) {
                work.has_device_failure = true;
                held_back_.emplace_back(*work.patient, failure, work.child->log_tail());
            } else {
                device_failures_ = 0;
                write(*work.patient, failure, work.child->log_tail());
            }
        }
    }

    void write_held_back() {
        for (const auto& [patient, failure, log] : held_back_) write(patient, failure, log);
        held_back_.clear();
    }

    void write(const CohortPatient& patient, const FinalFailure& failure, const std::string& log) {
        for (const CohortCase& c : patient.cases) {
            if (c.id != failure.case_id) continue;
            const fs::path file = folder_.failure_file(patient, c);
            make_folders(file.parent_path());
            replace_text(file, failure_text({c.key, failure.sentence, host_name(), log,
                                             failure.code, failure.attempts}));
            count(patient, c, CaseStatus::failed);
            shared_failure_.add_failure(patient.id, failure.code, failure.sentence);
        }
        tell(patient, failure.case_id, failure.code, failure.sentence);
    }

    void tell(const CohortPatient& patient, const std::string& case_id, int code,
              const std::string& sentence) const {
        if (!options_.tell_case) return;
        nlohmann::ordered_json json{{"patient", patient.id}, {"case", case_id},
                                    {"code", code},          {"sentence", sentence},
                                    {"over", num_over()},    {"of", run_.num_cases}};
        options_.tell_case(
            json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    }

    /// Whether nothing of the patient is left to do here.
    bool is_over(PatientInWork& work) {
        if (!work.has_ended) watch(work);
        if (!work.has_ended || !trial_.is_passed(work.trial)) return false;
        for (const CaseFault& fault : work.faults)
            note_failure(work, fault.case_id, fault.code, fault.why);
        work.child.reset();
        stop_without_device(work);
        stop_if_all_fail();
        if (!work.queue.is_empty()) return false;
        left_s_ -= work.patient->estimate_s;
        finished_s_ += work.patient->estimate_s;
        return true;
    }

    void watch(PatientInWork& work) {
        take_news(work);
        work.end_beyond_limits(plan_.head().limits.memory_mb);
        const auto end = work.child->ended();
        if (end) take_news(work);
        if (output_failure_)
            stop_with(ErrorCode::output_failed,
                      *output_failure_ + "; make room, and run again: what is done stays");
        if (!end) return;
        work.has_ended = true;
        work.append_log_to(folder_.log_file(*work.patient));
        bool is_suspect = !work.faults.empty();
        if (!work.unreported.empty() && !is_interrupted()) {
            work.faults.push_back(work.unsaid_fault(*end));
            is_suspect |= work.may_be_of_machine(*end);
        }
        if (is_suspect) work.trial = trial_.ask();
    }

    /// Whether what failed is to blame, or the machine.
    void try_machine() {
        trial_.watch();
        if (!trial_.failure()) return;
        std::string first;
        for (const PatientInWork& work : in_work_)
            if (first.empty() && !work.faults.empty()) first = work.faults.front().why;
        stop_with(
            ErrorCode::device_failed,
            fmt::format("{} cannot recover even a tiny phantom that is built in ({}), so what "
                        "failed here stays waiting for another machine; before that: {}",
                        host_name(), *trial_.failure(), first));
    }

    void stop_without_device(PatientInWork& work) {
        if (!work.has_device_failure || !work.queue.is_empty()) return;
        if (++device_failures_ < most_device_failures) return;
        const std::string sentence = std::get<FinalFailure>(held_back_.back()).sentence;
        stop_with(ErrorCode::device_failed,
                  fmt::format("{} patients in a row failed on this machine's device, so they stay "
                              "waiting; the last: {}",
                              most_device_failures, sentence));
    }

    void stop_if_all_fail() {
        const auto sentence = options_.keep_going ? std::nullopt : shared_failure_.sentence();
        if (!sentence) return;
        stop_with(
            ErrorCode::cancelled,
            fmt::format("{} cases failed alike and none worked, so the others stay waiting: {}; "
                        "mend it and run again (these with --retry-failed), or --keep-going",
                        SharedFailure::enough, *sentence));
    }

    const CohortRunOptions& options_;
    const ProgressSink& progress_;
    CohortFolder folder_;
    PlanFile plan_;
    double limit_s_;
    JournalFile journal_;
    MachineTrial trial_;
    CohortRun run_;
    std::deque<std::size_t> waiting_;  ///< positions in the plan
    std::list<PatientInWork> in_work_;
    std::set<std::string> counted_;  ///< patient/case, of patients with something left
    bool are_all_busy_ = false;
    Clock::time_point begin_ = Clock::now(), last_claims_ = {};
    double left_s_ = 0, finished_s_ = 0;  ///< estimates of patients
    int device_failures_ = 0;
    SharedFailure shared_failure_;
    std::vector<std::tuple<CohortPatient, FinalFailure, std::string>> held_back_;
    std::optional<std::string> output_failure_;
};

}  // namespace

CohortRun run_cohort(const CohortRunOptions& options, const ProgressSink& progress) {
    return CohortRunner(options, progress).run();
}

}  // namespace palpate
