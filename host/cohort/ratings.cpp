// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/ratings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/cohort/cohort_plan.hpp"
#include "host/io/delimited_text.hpp"
#include "solver/base/error.hpp"

namespace palpate {

Ratings::Ratings(const std::filesystem::path& file) {
    const DelimitedText table = parse_delimited(text_of_file(file), {'\t'});
    const auto patient = table.find("patient"), case_id = table.find("case_id"),
               rating = table.find("rating"), key = table.find("key");
    if (!table.faults.empty() || !patient || !case_id || !rating || !key)
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{}: it is no table with the columns patient, case_id, rating and "
                                "key; take the file that the gallery hands over",
                                file.string()));
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const auto& row = table.rows[k];
        const std::string& word = row[*rating];
        if (word != "accept" && word != "reject" && word != "unsure")
            throw Error(ErrorCode::input_unusable,
                        fmt::format("{}, line {}: \"{}\" is no rating; allowed: accept, reject, "
                                    "unsure",
                                    file.string(), table.lines[k], word));
        rows_[{row[*patient], row[*case_id]}] = {word, row[*key].substr(0, short_key_digits)};
    }
}

std::string Ratings::of(const std::string& patient, const std::string& case_id,
                        const std::string& key) {
    const auto found = rows_.find({patient, case_id});
    if (found == rows_.end() || found->second.key != key.substr(0, short_key_digits)) return "";
    found->second.is_used = true;
    return found->second.rating;
}

std::size_t Ratings::num_unused() const {
    return static_cast<std::size_t>(std::count_if(
        rows_.begin(), rows_.end(), [](const auto& row) { return !row.second.is_used; }));
}

}  // namespace palpate
