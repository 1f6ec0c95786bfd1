// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/verdict.hpp"

#include <array>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::array<const char*, 6> words_of_verdicts{"recovered",  "weak",  "not identifiable",
                                                       "not judged", "given", "hollow"};

}  // namespace

const char* name_of(Verdict verdict) {
    return words_of_verdicts.at(static_cast<std::size_t>(verdict));
}

Verdict verdict_of(std::string_view words) {
    std::string allowed;
    for (std::size_t k = 0; k < words_of_verdicts.size(); ++k) {
        if (words == words_of_verdicts[k]) return static_cast<Verdict>(k);
        allowed += std::string(allowed.empty() ? "\"" : ", \"") + words_of_verdicts[k] + '"';
    }
    throw Error(ErrorCode::invalid_argument,
                "\"" + std::string(words) + "\" is no verdict; allowed: " + allowed);
}

}  // namespace palpate
