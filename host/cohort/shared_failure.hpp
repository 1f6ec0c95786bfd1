// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>

namespace palpate {

/// Cases of several patients that all fail with one code, where nothing has worked: what is wrong
/// is wrong with all of them, and those that are left need not be tried. What took too long or too
/// much memory does not count: the machine may be to blame.
class SharedFailure {
public:
    static constexpr int enough = 20, enough_patients = 5;

    void add_failure(const std::string& patient, int code, const std::string& sentence);
    void add_result() { is_ruled_out_ = true; }
    /// The first one's sentence once `enough` cases of `enough_patients` have failed with its code
    /// and none otherwise.
    std::optional<std::string> sentence() const;

private:
    bool is_ruled_out_ = false;
    int count_ = 0, code_ = 0;
    std::set<std::string> patients_;
    std::string first_;
};

}  // namespace palpate
