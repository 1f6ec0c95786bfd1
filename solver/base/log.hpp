// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace palpate {

/// One step of a long computation. `fraction` is 0..1 within the stage, or negative if unknown.
struct Progress {
    std::string stage;  ///< short, lower case: "meshing", "condensing", "searching"
    double fraction = -1;
    std::string message;  ///< what is going on, with numbers; may be empty
};

/// Where progress goes. The library never prints: the command line installs a sink.
/// A sink may throw `Error` to cancel. A report with an empty stage is no news: only a moment at
/// which it may do so.
using ProgressSink = std::function<void(const Progress&)>;

inline void report_progress(const ProgressSink& sink, std::string stage, double fraction,
                            std::string message = {}) {
    if (sink) sink(Progress{std::move(stage), fraction, std::move(message)});
}

/// For long work between reports, so that cancelling never waits for more than about a second: lets
/// the sink throw. From any thread.
inline void check_cancelled(const ProgressSink& sink) {
    if (sink) sink(Progress{});
}

}  // namespace palpate
