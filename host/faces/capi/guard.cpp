// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/capi/guard.hpp"

#include <chrono>
#include <memory>
#include <mutex>

namespace palpate::capi {

std::string& last_error() {
    thread_local std::string text;
    return text;
}

palpate_status status_of(ErrorCode code) {
    if (code == ErrorCode::cancelled) return PALPATE_CANCELLED;
    return static_cast<palpate_status>(exit_code_of(code));
}

void require(const void* pointer, const char* what) {
    if (!pointer) throw Error(ErrorCode::invalid_argument, std::string(what) + " is null");
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds pause_between_repeats{100};

/// The callback of a caller: one call at a time, and after it has cancelled always the same answer.
/// Reports without news repeat the stage, not too often.
class Caller {
public:
    Caller(palpate_progress callback, void* user) : callback_(callback), user_(user) {}

    void tell(const Progress& progress) {
        const std::lock_guard lock(mutex_);
        const bool is_news = !progress.stage.empty();
        if (is_news) stage_ = progress.stage;
        if (!has_cancelled_ && (is_news || Clock::now() - last_call_ > pause_between_repeats)) {
            last_call_ = Clock::now();
            has_cancelled_ = callback_(user_, stage_.c_str(), is_news ? progress.fraction : -1,
                                       progress.message.c_str()) != 0;
        }
        if (has_cancelled_) throw Error(ErrorCode::cancelled, "cancelled while " + stage_);
    }

private:
    palpate_progress callback_;
    void* user_;
    std::string stage_ = "starting";
    Clock::time_point last_call_;
    bool has_cancelled_ = false;
    std::mutex mutex_;
};

}  // namespace

ProgressSink progress_sink(palpate_progress callback, void* user) {
    if (!callback) return {};
    auto caller = std::make_shared<Caller>(callback, user);
    return [caller](const Progress& progress) { caller->tell(progress); };
}

}  // namespace palpate::capi
