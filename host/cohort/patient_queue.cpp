// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/patient_queue.hpp"

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Whether the same would happen again: input, mesh and mechanics are what they are.
bool is_final(int code) { return code >= 2 && code <= 6; }

constexpr double second_limit = 2;  // of what took too long
bool is_late(int code) { return code == exit_code_of(ErrorCode::time_limit); }

}  // namespace

PatientQueue::PatientQueue(std::vector<std::string> waiting, int most_attempts)
    : order_(std::move(waiting)), most_attempts_(most_attempts) {
    for (const std::string& id : order_) attempts_[id] = 0;
}

NextWork PatientQueue::next() const {
    NextWork work;
    for (const std::string& id : order_)
        if (const auto found = attempts_.find(id); found != attempts_.end() && found->second == 0)
            work.cases.push_back(id);
    const auto is_last = [&](int tried) { return tried > 0 && tried == most_attempts_ - 1; };
    work.on_reference_backend = is_last(of_all_);
    if (is_all_late_) work.limit_factor = second_limit;
    if (!work.cases.empty()) return work;
    const auto least = std::min_element(
        order_.begin(), order_.end(), [&](const std::string& a, const std::string& b) {
            const auto tried = [&](const std::string& id) {
                const auto found = attempts_.find(id);
                return found == attempts_.end() ? 1 << 20 : found->second;
            };
            return tried(a) < tried(b);
        });
    work.cases = {*least};
    work.on_reference_backend |= is_last(attempts_.at(*least));
    if (late_.count(*least)) work.limit_factor = second_limit;
    return work;
}

void PatientQueue::done(const std::string& case_id) { attempts_.erase(case_id); }

std::vector<FinalFailure> PatientQueue::failed(const std::string& case_id, int code,
                                               const std::string& sentence) {
    std::vector<FinalFailure> over;
    if (!case_id.empty()) {
        const auto found = attempts_.find(case_id);
        if (found == attempts_.end()) return over;
        const bool is_second_time = is_late(code) && !late_.insert(case_id).second;
        if (++found->second < most_attempts_ && !is_final(code) && !is_second_time) return over;
        over.push_back({case_id, code, found->second, sentence});
        attempts_.erase(found);
        return over;
    }
    const bool is_second_time = is_late(code) && is_all_late_;
    is_all_late_ |= is_late(code);
    if (++of_all_ < most_attempts_ && !is_final(code) && !is_second_time) return over;
    for (const std::string& id : order_)
        if (attempts_.count(id)) over.push_back({id, code, of_all_, sentence});
    attempts_.clear();
    return over;
}

}  // namespace palpate
