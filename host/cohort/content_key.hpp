// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace palpate {

/// Raised only when the same input gives other answers, or a case other files, than before; not
/// with every version.
inline constexpr int numerics_version = 10;
/// The same for tissue at large deformation, whose answers change more often.
inline constexpr int large_deformation_version = 2;

/// SHA-256 (FIPS 180-4) in 64 hexadecimal digits.
std::string sha256_of(std::string_view bytes);
/// Of a file's content. Throws Error(input_unreadable) naming the file.
std::string sha256_of_file(const std::filesystem::path& path);

/// Everything the answer of a case depends on.
struct KeyParts {
    std::string settings_toml;                   ///< the parsed settings, written again
    std::map<std::string, std::string> options;  ///< those that change answers, by name
    std::string reference_sha256, target_sha256;
    std::string transform_sha256;  ///< empty: none
    bool is_test_stub = false;     ///< nothing is computed: never the key of a real result
};

/// SHA-256 of these and `numerics_version` as JSON with sorted keys. No path, no name, nothing
/// about where and how fast it is computed.
std::string case_key(const KeyParts& parts);

/// The same for many cases whose settings and options are those of `parts`.
class CaseKeys {
public:
    explicit CaseKeys(const KeyParts& parts);
    std::string key(const std::string& reference_sha256, const std::string& target_sha256,
                    const std::string& transform_sha256) const;

private:
    std::string before_reference_, before_target_, before_transform_;
};

}  // namespace palpate
