// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace palpate {

/// A program from its start to its end: signals are caught (`catch_interrupts`), and what `work`
/// throws becomes one sentence on standard error, "<name>: <sentence>", and the exit code that
/// docs/errors.md lists; without a throw that is what `work` returns. `before_last_words` is called
/// before such a sentence. To be called from main, before any other thread starts.
[[noreturn]] void run_program(const std::string& name, const std::function<int()>& work,
                              const std::function<void()>& before_last_words = {});

}  // namespace palpate
