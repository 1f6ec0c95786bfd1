// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <csignal>

namespace palpate {

/// While one lives, a driver may take the process's signals; at its end they are given back. LLVM,
/// with which PoCL compiles, puts handlers of its own in the place of ours once in a process, and
/// those let the second of two quick signals end it at once, with nothing tidied up.
class KeptSignals {
public:
    KeptSignals() {
        for (std::size_t k = 0; k < kept.size(); ++k) sigaction(kept[k], nullptr, &actions_[k]);
    }
    ~KeptSignals() {
        for (std::size_t k = 0; k < kept.size(); ++k) sigaction(kept[k], &actions_[k], nullptr);
    }
    KeptSignals(const KeptSignals&) = delete;
    KeptSignals& operator=(const KeptSignals&) = delete;

private:
    static constexpr std::array kept{SIGHUP, SIGINT, SIGTERM, SIGQUIT, SIGABRT};
    std::array<struct sigaction, kept.size()> actions_{};
};

}  // namespace palpate
