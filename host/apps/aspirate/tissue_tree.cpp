// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_tree.hpp"

#include <fmt/format.h>

#include <map>
#include <variant>

#include "host/apps/aspirate/tissue_experiment.hpp"

namespace palpate {
namespace {

/// How a number of the tissue is told.
struct Told {
    const char* symbol;
    const char* name;   ///< in files
    const char* title;  ///< for people
    double factor = 1;
};

const Told* told_of(const std::string& name) {
    static const std::map<std::string, Told> all{
        {"mu_kpa",
         {"mu", "young_modulus_kpa", "Young's modulus, slow and small strain (6 mu)",
          young_over_mu}},
        {"c1_kpa",
         {"c1", "young_modulus_kpa", "Young's modulus, slow and small strain (6 C1)",
          young_over_mu}},
        {"c2_kpa", {"c2", "c2_kpa", "Stiffening with stretch, C2"}},
        {"gamma", {"gamma", "gamma", "Stiffening with stretch, gamma"}},
        {"amplitude",
         {"C", "amplitude", "Relaxing part, C: 1 + the sum of C times as stiff at once"}},
        {"time_s", {"tau", "time_s", "Relaxation time, tau"}}};
    const auto found = all.find(name);
    return found == all.end() ? nullptr : &found->second;
}

}  // namespace

ResultTree tissue_tree(const IdentifiedExperiment& found) {
    const std::string distrust = found.distrust();
    ResultTree tree{.name = "tissue",
                    .title = distrust.empty() ? "Tissue" : "Tissue: do not trust these values"};
    std::map<std::string, int> count;
    for (const IdentifiedParameter& one : found.identified.parameters) {
        const Told* told = one.parameter.is_nuisance ? nullptr : told_of(one.parameter.name);
        if (!told) continue;
        const int term = ++count[told->name];  // of the relaxation, where there are several
        Figure figure{
            .name = told->name,
            .value = told->factor * one.value,
            .unit = one.parameter.unit,
            .title = told->title,
            .verdict = distrust.empty() ? one.judgement.verdict : Verdict::not_judged,
            .reason = distrust.empty() ? one.judgement.reason : "the model is none of this film"};
        if (term > 1) {
            figure.name += fmt::format("_{}", term);
            figure.title += fmt::format(", term {}", term);
        }
        figure.interval_95 = {told->factor * one.interval[0], told->factor * one.interval[1]};
        tree.add(std::move(figure));
    }
    return tree;
}

std::string tissue_sentence(const IdentifiedExperiment& found) {
    std::string text;
    std::map<std::string, int> count;
    int last_term = 1;
    for (const IdentifiedParameter& one : found.identified.parameters) {
        if (one.parameter.is_nuisance) continue;
        const Told* told = told_of(one.parameter.name);
        const int term = ++count[one.parameter.name];
        std::string before = text.empty() ? "" : ", ";
        if (term > last_term) before = fmt::format("; term {}: ", last_term = term);
        text += fmt::format("{}{} {:.3g}{}{}", before, told ? told->symbol : one.parameter.name,
                            one.value, one.parameter.unit.empty() ? "" : " ", one.parameter.unit);
    }
    return text;
}

}  // namespace palpate
