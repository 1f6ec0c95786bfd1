// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/sensitivity/columns_beside.hpp"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "solver/base/serial_blas.hpp"

namespace palpate {

/// The body at the times of its history, with a factor of the tangent at each.
class ColumnsBeside::Body {
public:
    Body(const SolidModel& model, std::vector<LoadTime> times,
         std::vector<HistoryDirection> directions, const EquilibriumOptions& options)
        : has_relaxation_(has_relaxation(model)),
          times_(std::move(times)),
          columns_(model, times_, std::move(directions)),
          solid_(model, options.loops),
          tangent_(std::make_shared<TangentSolve>(solid_, options.linear)),
          history_(model) {}

    ColumnsAtTime advance(Equilibrium found) {
        // It says why there are none.
        if (next_ >= times_.size() || !found.converged) return columns_.advance(solid_, found);
        const LoadTime& at = times_[next_];
        const double dt_s = at.time_s - (next_ == 0 ? 0 : times_[next_ - 1].time_s);
        if (has_relaxation_) history_.begin_step(dt_s, solid_);
        ContactAssembly& contact = tangent_->contact();
        contact.begin(start_);
        contact.place(at.loads.obstacle_motion);
        contact.renew_limits(found.displacement);
        tangent_->pressure().set(at.loads.pressure_kpa);
        // The factor is of the time before. Friction has a new one made anyway.
        if (!contact.has_friction()) tangent_->factorise(found.displacement);
        found.tangent = tangent_;
        ColumnsAtTime columns = columns_.advance(solid_, found);
        if (has_relaxation_) history_.end_step(dt_s, std::move(found.relaxing_stress));
        start_ = {std::move(found.displacement), at.loads.obstacle_motion,
                  std::move(found.contact.friction)};
        ++next_;
        return columns;
    }

private:
    bool has_relaxation_;
    std::vector<LoadTime> times_;
    HistoryColumns columns_;
    SolidAssembly solid_;
    std::shared_ptr<TangentSolve> tangent_;
    ViscousHistory history_;
    ContactStart start_;
    std::size_t next_ = 0;
};

class ColumnsBeside::Work {
public:
    Work(const SolidModel& model, const std::vector<LoadTime>& times,
         std::vector<HistoryDirection> directions, const EquilibriumOptions& options)
        : body_(model, times, std::move(directions), options), thread_([this] { run(); }) {}

    ~Work() {
        {
            const std::lock_guard lock(mutex_);
            is_stopped_ = true;
        }
        changed_.notify_all();
    }

    void follow(const Equilibrium& found) {
        Equilibrium next;
        next.converged = found.converged;
        next.displacement = found.displacement;
        next.relaxing_stress = found.relaxing_stress;
        next.contact.friction = found.contact.friction;
        {
            const std::lock_guard lock(mutex_);
            if (failure_) std::rethrow_exception(failure_);
            queue_.push_back(std::move(next));
            ++num_queued_;
        }
        changed_.notify_all();
    }

    std::vector<ColumnsAtTime> finish(const ProgressSink& progress) {
        using namespace std::chrono_literals;
        std::unique_lock lock(mutex_);
        const auto is_done = [&] { return failure_ || columns_.size() == num_queued_; };
        while (!changed_.wait_for(lock, 200ms, is_done)) {
            lock.unlock();
            check_cancelled(progress);
            lock.lock();
        }
        if (failure_) std::rethrow_exception(failure_);
        num_queued_ = 0;
        return std::exchange(columns_, {});
    }

private:
    void run() {
        for (std::unique_lock lock(mutex_);;) {
            changed_.wait(lock, [&] { return is_stopped_ || !queue_.empty(); });
            if (is_stopped_) return;
            Equilibrium next = std::move(queue_.front());
            queue_.pop_front();
            lock.unlock();
            try {
                ColumnsAtTime found = body_.advance(std::move(next));
                lock.lock();
                columns_.push_back(std::move(found));
            } catch (...) {
                if (!lock.owns_lock()) lock.lock();
                failure_ = std::current_exception();
                is_stopped_ = true;
            }
            changed_.notify_all();
        }
    }

    const SerialBlas serial_;  // its threads would wait for each other
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Equilibrium> queue_;
    std::size_t num_queued_ = 0;
    std::vector<ColumnsAtTime> columns_;
    std::exception_ptr failure_;
    bool is_stopped_ = false;
    Body body_;
    std::jthread thread_;  // the last: it ends before what it works with
};

ColumnsBeside::ColumnsBeside(const SolidModel& model, const std::vector<LoadTime>& times,
                             std::vector<HistoryDirection> directions,
                             const EquilibriumOptions& options)
    : work_(std::make_unique<Work>(model, times, std::move(directions), options)) {}

ColumnsBeside::ColumnsBeside(ColumnsBeside&&) noexcept = default;
ColumnsBeside::~ColumnsBeside() = default;

void ColumnsBeside::follow(const Equilibrium& found) { work_->follow(found); }

std::vector<ColumnsAtTime> ColumnsBeside::finish(const ProgressSink& progress) {
    return work_->finish(progress);
}

}  // namespace palpate
