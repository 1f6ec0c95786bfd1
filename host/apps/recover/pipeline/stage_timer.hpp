// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// Wall time of the stages of a run, in order.
class StageTimer {
public:
    void start(std::string stage) {
        stop();
        stage_ = std::move(stage);
        begin_ = Clock::now();
    }
    void stop() {
        if (!stage_.empty()) {
            times_.emplace_back(stage_,
                                std::chrono::duration<double>(Clock::now() - begin_).count());
        }
        stage_.clear();
    }
    const std::vector<std::pair<std::string, double>>& times_s() const { return times_; }

private:
    using Clock = std::chrono::steady_clock;
    std::string stage_;
    Clock::time_point begin_;
    std::vector<std::pair<std::string, double>> times_;
};

}  // namespace palpate
