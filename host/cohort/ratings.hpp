// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

namespace palpate {

/// What a person said of cases in the gallery: the file ratings.tsv that it hands over.
class Ratings {
public:
    Ratings() = default;
    /// Of a file with the columns patient, case_id, rating and key; a later row replaces an earlier
    /// one of the same case. Throws Error(input_unreadable) naming the file, Error(input_unusable)
    /// naming the line of a rating that is none.
    explicit Ratings(const std::filesystem::path& file);

    /// "accept", "reject" or "unsure"; empty without one, or if it is of a result with another key.
    std::string of(const std::string& patient, const std::string& case_id, const std::string& key);
    /// How many are of another result, or of no case that was asked for.
    std::size_t num_unused() const;

private:
    struct Row {
        std::string rating, key;  ///< the first digits of it
        bool is_used = false;
    };
    std::map<std::pair<std::string, std::string>, Row> rows_;
};

/// As many digits of a key as tell results of a case apart.
inline constexpr std::size_t short_key_digits = 16;

}  // namespace palpate
