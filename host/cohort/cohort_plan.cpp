// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/cohort_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::array<const char*, 3> words_of_kept{"table", "compact", "all"};
constexpr double shortest_limit_s = 60, limit_factor = 10;

}  // namespace

const char* name_of(KeptFiles keep) { return words_of_kept.at(static_cast<std::size_t>(keep)); }

KeptFiles kept_files_of(std::string_view word) {
    for (std::size_t k = 0; k < words_of_kept.size(); ++k)
        if (word == words_of_kept[k]) return static_cast<KeptFiles>(k);
    throw Error(ErrorCode::invalid_argument,
                fmt::format("keep is \"{}\"; allowed: table, compact, all", word));
}

std::size_t CohortPlan::num_cases() const {
    std::size_t sum = 0;
    for (const CohortPatient& p : patients)
        sum += static_cast<std::size_t>(std::count_if(
            p.cases.begin(), p.cases.end(), [](const auto& c) { return c.excluded.empty(); }));
    return sum;
}

double limit_s(const PlanHead& plan) {
    if (plan.limits.target_s > 0) return plan.limits.target_s;
    return std::max(shortest_limit_s, limit_factor * reference_estimate_s);
}

void replace_text(const fs::path& path, const std::string& text) {
    write_atomically(path, [&](const fs::path& temporary) { write_text_file(temporary, text); });
}

std::string text_of_file(const fs::path& path) {
    if (const auto why = why_unreadable(path))
        throw Error(ErrorCode::input_unreadable, path.string() + ": " + *why);
    std::ifstream in(path, std::ios::binary);
    std::string text(fs::file_size(path), '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

}  // namespace palpate
