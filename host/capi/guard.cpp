// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/capi/guard.hpp"

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

ProgressSink progress_sink(palpate_progress callback, void* user) {
    if (!callback) return {};
    auto one_at_a_time = std::make_shared<std::mutex>();
    return [callback, user, one_at_a_time](const Progress& progress) {
        const std::lock_guard lock(*one_at_a_time);
        if (callback(user, progress.stage.c_str(), progress.fraction, progress.message.c_str()))
            throw Error(ErrorCode::cancelled, "cancelled while " + progress.stage);
    };
}

}  // namespace palpate::capi
