// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace palpate {

/// Why an operation failed. The command line turns each into one exit code (`exit_code_of`).
enum class ErrorCode {
    internal,             ///< a defect of palpate itself
    invalid_argument,     ///< an option or setting outside its allowed range
    unsupported,          ///< a valid request that this build or back end cannot serve
    input_unreadable,     ///< a file that is missing, damaged or of an unknown format
    input_unusable,       ///< a readable input that makes no sense: empty label, no overlap, ...
    mesh_failed,          ///< no valid mesh could be made
    solve_failed,         ///< the forward solver broke down
    device_unavailable,   ///< no such OpenCL platform or device
    kernel_build_failed,  ///< a device program did not compile
    device_failed,        ///< the device reported an error while running
    out_of_memory,        ///< host or device memory
    cancelled,            ///< the user or a callback asked for it
    time_limit,           ///< a limit set by the user or by a child process
    output_failed,        ///< the result could not be written
};

/// The only exception type that palpate throws. The message is one sentence for the user: what
/// failed, with which value, what is allowed, what to try.
class Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ErrorCode code() const { return code_; }

private:
    ErrorCode code_;
};

/// Stable, documented process exit codes: 0 ok; 1 internal; 2 usage; 3 unreadable input;
/// 4 unusable input; 5 meshing; 6 forward solve; 7 not converged; 8 device; 9 time limit
/// or cancelled; 10 output.
constexpr int exit_code_not_converged = 7;

constexpr int exit_code_of(ErrorCode code) {
    switch (code) {
        case ErrorCode::internal:
            return 1;
        case ErrorCode::invalid_argument:
            return 2;
        case ErrorCode::unsupported:
            return 2;
        case ErrorCode::input_unreadable:
            return 3;
        case ErrorCode::input_unusable:
            return 4;
        case ErrorCode::mesh_failed:
            return 5;
        case ErrorCode::solve_failed:
            return 6;
        case ErrorCode::device_unavailable:
            return 8;
        case ErrorCode::kernel_build_failed:
            return 8;
        case ErrorCode::device_failed:
            return 8;
        case ErrorCode::out_of_memory:
            return 8;
        case ErrorCode::cancelled:
            return 9;
        case ErrorCode::time_limit:
            return 9;
        case ErrorCode::output_failed:
            return 10;
    }
    return 1;
}

}  // namespace palpate
