// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <new>
#include <system_error>

#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/memory_limit.hpp"
#include "host/pipeline/version.hpp"
#include "solver/base/error.hpp"
#include "solver/base/large_blocks.hpp"

namespace {

int fail(int code, const std::string& message) {
    palpate::begin_to_end(code);
    palpate::end_progress_line();
    fmt::print(stderr, "palpate: {}\n", message);
    return code;
}

int parse_and_run(int argc, char** argv) {
    CLI::App app{
        "Computational palpation: stiffness, forces and deformation from two segmentations"};
    app.name("palpate");
    app.set_version_flag("--version", "palpate " + palpate::version_text());
    app.require_subcommand(1);
    app.footer(
        "Exit codes: 0 ok, 1 internal, 2 usage, 3 unreadable input, 4 unusable input, 5 meshing,\n"
        "6 forward solve, 7 not converged (result written), 8 device, 9 time limit or cancelled,\n"
        "10 output.\n"
        "Not a medical device.");
    palpate::Run run;
    palpate::add_recover(app, run);
    palpate::add_phantom(app, run);
    palpate::add_simulate(app, run);
    palpate::add_study(app, run);
    palpate::add_warp(app, run);
    palpate::add_export(app, run);
    palpate::add_devices(app, run);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return fail(exit_code_of(palpate::ErrorCode::invalid_argument),
                    fmt::format("{}; see `palpate --help`", error.what()));
    }
    palpate::prepare_for_memory_limit();
    return run();
}

/// What `work` throws, as a sentence and an exit code. Whatever breaks once a signal has come, a
/// child that was ended by it for example, was stopped and did not fail.
int guarded(const std::function<int()>& work) {
    constexpr const char* out_of_memory =
        "out of memory; use fewer --nodes or coarser label volumes";
    const int out_of_memory_code = exit_code_of(palpate::ErrorCode::out_of_memory);
    try {
        try {
            return work();
        } catch (...) {
            palpate::throw_if_interrupted();
            throw;
        }
    } catch (const palpate::Error& error) {
        return fail(exit_code_of(error.code()), error.what());
    } catch (const std::bad_alloc&) {
        return fail(out_of_memory_code, out_of_memory);
    } catch (const std::system_error& error) {
        const int reason = error.code().value();  // a thread that cannot be started
        if (reason == EAGAIN || reason == ENOMEM) return fail(out_of_memory_code, out_of_memory);
        return fail(1, fmt::format("internal error: {}; please report it", error.what()));
    } catch (const std::exception& error) {
        return fail(1, fmt::format("internal error: {}; please report it", error.what()));
    }
}

}  // namespace

int main(int argc, char** argv) {
    palpate::keep_large_blocks();
    std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error of writing it
    palpate::catch_interrupts();
    palpate::end_program(guarded([&] { return parse_and_run(argc, argv); }));
}
