// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/log.hpp"

namespace palpate {

/// Progress on standard error: on a terminal one line per stage that is rewritten in place,
/// elsewhere a plain line per message. Quiet prints nothing.
/// Throws Error(cancelled) once a signal asked the program to end.
ProgressSink console_progress(bool quiet);

/// Ends the line that is being rewritten, so that what follows starts on a fresh one.
void end_progress_line();

}  // namespace palpate
