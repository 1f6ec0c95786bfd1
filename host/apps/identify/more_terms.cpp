// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/more_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace palpate {
namespace {

struct Term {
    double amplitude, time_s;
};

std::string path_of(std::size_t term, const char* number) {
    return fmt::format("material[1].relaxation[{}].{}", term + 1, number);
}

bool is_amplitude(const std::string& path) {
    return path.starts_with("material[1].relaxation[") && path.ends_with("].amplitude");
}

void split_strongest(std::vector<Term>& terms) {
    const auto strongest =
        std::max_element(terms.begin(), terms.end(),
                         [](const Term& a, const Term& b) { return a.amplitude < b.amplitude; });
    strongest->amplitude /= 2;
    strongest->time_s /= 2;
    terms.push_back({strongest->amplitude, 4 * strongest->time_s});
}

}  // namespace

Eigen::VectorXd start_with_more_terms(const Experiment& from, const Eigen::VectorXd& values,
                                      const Experiment& to) {
    std::map<std::string, double> known;
    for (std::size_t k = 0; k < from.paths().size(); ++k)
        known[from.paths()[k]] = values[Eigen::Index(k)];
    std::vector<Term> terms;
    for (std::size_t k = 0; known.contains(path_of(k, "amplitude")); ++k)
        terms.push_back({known.at(path_of(k, "amplitude")), known.at(path_of(k, "time_s"))});
    const auto wanted =
        std::size_t(std::count_if(to.paths().begin(), to.paths().end(), is_amplitude));
    while (!terms.empty() && terms.size() < wanted) split_strongest(terms);
    for (std::size_t k = 0; k < terms.size(); ++k) {
        known[path_of(k, "amplitude")] = terms[k].amplitude;
        known[path_of(k, "time_s")] = terms[k].time_s;
    }
    Eigen::VectorXd start = starts_of(to.parameters());
    for (std::size_t k = 0; k < to.paths().size(); ++k)
        if (const auto found = known.find(to.paths()[k]); found != known.end())
            start[Eigen::Index(k)] = found->second;
    return start;
}

}  // namespace palpate
