// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// Where the address space is limited (ulimit -v, RLIMIT_AS): gets the buffers of OpenBLAS now,
/// which otherwise waits for ever when one cannot be had later, and lets crashes of libraries that
/// do not check for memory end with a sentence and the exit code of out_of_memory, if little of the
/// address space is left then. Nothing elsewhere. Throws Error(out_of_memory) if the limit is too
/// small for any work.
void prepare_for_memory_limit();

/// Ends the program. Where the address space is limited, without the exit handlers of libraries:
/// OpenBLAS then waits for its threads, which wait for memory.
[[noreturn]] void end_program(int code);

}  // namespace palpate
