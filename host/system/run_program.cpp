// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/run_program.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <csignal>
#include <new>
#include <system_error>

#include "host/system/interrupt.hpp"
#include "host/system/memory_limit.hpp"
#include "solver/base/error.hpp"
#include "solver/base/large_blocks.hpp"

namespace palpate {
namespace {

constexpr int internal_code = 1;

struct Failure {
    int code;
    std::string sentence;
};

Failure out_of_memory() {
    return {exit_code_of(ErrorCode::out_of_memory),
            "out of memory; use fewer --nodes or coarser label volumes"};
}

/// What the exception in flight says. Whatever breaks once a signal has come, a child that was
/// ended by it for example, was stopped and did not fail.
Failure failure_in_flight() {
    try {
        try {
            throw;
        } catch (...) {
            throw_if_interrupted();
            throw;
        }
    } catch (const Error& error) {
        return {exit_code_of(error.code()), error.what()};
    } catch (const std::bad_alloc&) {
        return out_of_memory();
    } catch (const std::system_error& error) {
        const int reason = error.code().value();  // a thread that cannot be started
        if (reason == EAGAIN || reason == ENOMEM) return out_of_memory();
        return {internal_code, fmt::format("internal error: {}; please report it", error.what())};
    } catch (const std::exception& error) {
        return {internal_code, fmt::format("internal error: {}; please report it", error.what())};
    }
}

}  // namespace

void run_program(const std::string& name, const std::function<int()>& work,
                 const std::function<void()>& before_last_words) {
    keep_large_blocks();
    std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error of writing it
    catch_interrupts(name);
    int code = 0;
    try {
        code = work();
    } catch (...) {
        const Failure failure = failure_in_flight();
        code = failure.code;
        begin_to_end(code);
        if (before_last_words) before_last_words();
        fmt::print(stderr, "{}: {}\n", name, failure.sentence);
    }
    end_program(code);
}

}  // namespace palpate
