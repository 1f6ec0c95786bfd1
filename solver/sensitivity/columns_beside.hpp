// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "solver/base/log.hpp"
#include "solver/sensitivity/history_columns.hpp"

namespace palpate {

/// `HistoryColumns` on a thread of their own: while the columns at one time are found, the history
/// goes on to the next. They have an assembly, contacts and a factor for each time to themselves,
/// which costs memory and a factorisation at each time that they would not need on the way; so
/// this is for bodies that do not keep all threads busy by themselves.
class ColumnsBeside {
public:
    /// At rest, before the first time.
    ///   model    must outlive this object
    ///   options  as `solve_history` has them
    /// Throws as `HistoryColumns` does.
    ColumnsBeside(const SolidModel& model, const std::vector<LoadTime>& times,
                  std::vector<HistoryDirection> directions, const EquilibriumOptions& options);
    ColumnsBeside(ColumnsBeside&&) noexcept;
    /// Waits until the columns of the time that is worked at are done; of the others there are
    /// none.
    ~ColumnsBeside();

    /// Queues the next time, whose equilibrium is `found`: to be called as
    /// `HistoryColumns::advance` is, from a `TimeObserver`, but the tangent of `found` is not
    /// touched. Throws what `HistoryColumns::advance` threw at a time before.
    void follow(const Equilibrium& found);

    /// Waits for the columns at all times that were queued, asking `progress` meanwhile, and gives
    /// them away. Throws what `HistoryColumns::advance` threw.
    std::vector<ColumnsAtTime> finish(const ProgressSink& progress);

private:
    class Body;
    class Work;
    std::unique_ptr<Work> work_;
};

}  // namespace palpate
