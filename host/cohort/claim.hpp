// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

namespace palpate {

/// A patient that this process works on: a lock on a file, held as long as this process or one that
/// inherited `descriptor` lives, whatever ends them. The file goes when the claim ends in good
/// order.
class Claim {
public:
    /// Empty if another process holds it. Where a file system has no locks everybody gets it: work
    /// may then be done twice, results stay single. Throws Error(output_failed) if there can be no
    /// such file.
    static std::optional<Claim> take(const std::filesystem::path& file);
    /// Whether somebody holds it now.
    static bool is_held(const std::filesystem::path& file);

    Claim(Claim&& other) noexcept;
    Claim& operator=(Claim&& other) noexcept;
    ~Claim();
    int descriptor() const { return descriptor_; }

private:
    Claim(std::filesystem::path file, int descriptor);
    void release();

    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace palpate
