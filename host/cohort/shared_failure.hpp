// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace palpate {

/// Cases of a run that all fail alike, from its first on: what is wrong is wrong with all of them,
/// and those that are left need not be tried.
class SharedFailure {
public:
    static constexpr int enough = 20;

    void add_failure(int code, const std::string& sentence);
    void add_result() { is_ruled_out_ = true; }
    /// The first one's sentence once `enough` cases have failed with its code and none otherwise.
    std::optional<std::string> sentence() const;

private:
    bool is_ruled_out_ = false;
    int count_ = 0, code_ = 0;
    std::string first_;
};

}  // namespace palpate
