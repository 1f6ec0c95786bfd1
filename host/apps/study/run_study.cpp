// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/run_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "host/apps/study/study_folder.hpp"
#include "solver/base/error.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

std::string duration_text(double seconds) {
    if (seconds < 90) return fmt::format("{:.0f} s", seconds);
    if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
    return fmt::format("{:.1f} h", seconds / 3600);
}

/// The work of one call of `run_study`, shared by its threads.
class Runner {
public:
    Runner(const Study& study, const StudyRunOptions& options, const ProgressSink& progress)
        : study_(study),
          options_(options),
          progress_(progress),
          folder_(study, options.folder, options.overwrite),
          rows_(study.cases.size()),
          failures_(study.cases.size()) {
        for (std::size_t k = 0; k < study.cases.size(); ++k) {
            const auto& there = folder_.rows();
            const auto at = std::find_if(there.begin(), there.end(), [&](const Row& row) {
                return row.text("case") == study.cases[k].id;
            });
            if (at == there.end())
                waiting_.push_back(k);
            else
                rows_[k] = *at;
        }
        num_resumed_ = study.cases.size() - waiting_.size();
    }

    StudyRun run() {
        write_rows();
        std::optional<SerialBlas> serial;  // cases side by side leave it no core of its own
        if (options_.jobs > 1) serial.emplace();
        std::vector<std::jthread> threads;
        num_others_ = std::max(0, std::min<int>(options_.jobs, int(waiting_.size())) - 1);
        for (int t = num_others_; t > 0; --t)
            threads.emplace_back([this] {
                work();
                const std::lock_guard lock(mutex_);
                --num_others_;
                one_is_done_.notify_one();
            });
        work();
        wait_for_others();
        for (std::jthread& thread : threads) thread.join();
        if (error_ && !is_told_to_stop_) std::rethrow_exception(error_);
        return summary();
    }

private:
    bool is_stopped() const {
        return is_broken_ || (options_.is_cancelled && options_.is_cancelled());
    }

    void work() {
        for (std::size_t next = next_++; next < waiting_.size() && !is_stopped(); next = next_++) {
            try {
                run_case(waiting_[next]);
            } catch (...) {
                const std::lock_guard lock(mutex_);
                if (!error_) error_ = std::current_exception();
                is_broken_ = true;
            }
        }
    }

    /// A sink may hear of a wish to stop only on the thread that called (Python's signals).
    void wait_for_others() {
        using namespace std::chrono_literals;
        std::unique_lock lock(mutex_);
        while (!one_is_done_.wait_for(lock, 200ms, [this] { return num_others_ == 0; })) {
            if (is_broken_ || !progress_) continue;
            try {
                offer({});
            } catch (...) {
                continue;  // kept by `offer`
            }
        }
    }

    void run_case(std::size_t k) {
        const StudyCase& work = study_.cases[k];
        tell(work, "");
        std::optional<Row> row;
        std::string failure;
        try {
            row = work.run([&](const Progress& inner) {
                if (is_stopped()) throw Error(ErrorCode::cancelled, "the study was stopped");
                if (!inner.stage.empty())
                    tell(work, inner.stage);
                else
                    send({});  // which asks whether to go on
            });
        } catch (const Error& error) {
            if (is_stopped()) return;
            failure = error.what();
        }
        const std::lock_guard lock(mutex_);
        ++num_done_;
        last_done_ = Clock::now();
        failures_[k] = failure;
        if (!row) return;
        rows_[k] = as_in_file(work.id, *row);
        write_rows();
    }

    /// What the file will hold of a row, so that a resumed study has the same rows as a whole one.
    Row as_in_file(const std::string& id, const Row& row) const {
        Row kept;
        kept.set("case", id);
        for (const std::string& column : study_.columns) kept.set(column, row.text(column));
        return kept;
    }

    void tell(const StudyCase& work, const std::string& stage) {
        if (!progress_) return;
        const std::lock_guard lock(mutex_);
        const std::size_t total = study_.cases.size(), done = num_resumed_ + num_done_;
        std::string message = fmt::format("{} of {} done", done, total);
        if (num_done_ > 0) message += fmt::format(", {} left", duration_text(seconds_left()));
        message += fmt::format("; {}{}{}", work.title, stage.empty() ? "" : ": ", stage);
        offer(Progress{study_.name, double(done) / double(total), message});
    }

    void send(const Progress& step) {
        if (!progress_) return;
        const std::lock_guard lock(mutex_);
        offer(step);
    }

    /// What the sink throws ends the study, not the case that was told of.
    void offer(const Progress& step) {
        try {
            progress_(step);
        } catch (...) {
            if (!error_) error_ = std::current_exception();
            is_told_to_stop_ = is_broken_ = true;
            throw;
        }
    }

    /// From the cases of this run that are done.
    double seconds_left() const {
        const std::chrono::duration<double> spent = last_done_ - begin_;
        const std::chrono::duration<double> since = Clock::now() - last_done_;
        const double left = double(study_.cases.size() - num_resumed_ - num_done_);
        return std::max(0.0, spent.count() / double(num_done_) * left - since.count());
    }

    void write_rows() const { folder_.write_rows(done_rows()); }

    std::vector<Row> done_rows() const {
        std::vector<Row> rows;
        for (const auto& row : rows_)
            if (row) rows.push_back(*row);
        return rows;
    }

    StudyRun summary() const {
        StudyRun run;
        run.rows = done_rows();
        for (std::size_t k = 0; k < failures_.size(); ++k)
            if (!failures_[k].empty()) run.failures.emplace_back(study_.cases[k].id, failures_[k]);
        run.num_cases = study_.cases.size();
        run.num_resumed = num_resumed_;
        run.is_cancelled = is_stopped() && run.rows.size() < run.num_cases;
        run.stopped_by = error_;
        return run;
    }

    const Study& study_;
    const StudyRunOptions& options_;
    const ProgressSink& progress_;
    StudyFolder folder_;
    std::vector<std::optional<Row>> rows_;  ///< by case
    std::vector<std::string> failures_;     ///< by case
    std::vector<std::size_t> waiting_;      ///< cases without a row
    std::size_t num_resumed_ = 0, num_done_ = 0;
    std::atomic<std::size_t> next_ = 0;
    std::atomic<bool> is_broken_ = false, is_told_to_stop_ = false;
    std::exception_ptr error_;
    std::mutex mutex_;
    std::condition_variable one_is_done_;
    int num_others_ = 0;  ///< threads beside the one that called
    Clock::time_point begin_ = Clock::now(), last_done_ = begin_;
};

}  // namespace

StudyRun run_study(const Study& study, const StudyRunOptions& options,
                   const ProgressSink& progress) {
    return Runner(study, options, progress).run();
}

}  // namespace palpate
