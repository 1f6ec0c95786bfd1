// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/relaxation_step.hpp"

#include <cmath>

namespace palpate {
namespace {

/// g of a sum of amplitudes: what is left after an endless time.
double lasting_part(const SolidMaterial& material, double sum) {
    return material.is_instantaneous ? 1 / (1 + sum) : 1;
}

double sum_of_amplitudes(std::span<const RelaxationTerm> terms) {
    double sum = 0;
    for (const RelaxationTerm& term : terms) sum += term.amplitude;
    return sum;
}

/// (1 - exp(-x)) / x
double mean_left(double x) { return -std::expm1(-x) / x; }

double slope_with(const RelaxationStep& slopes, const RelaxationStep& change) {
    double sum = slopes.factor * change.factor;
    for (std::size_t k = 0; k < slopes.terms.size(); ++k)
        sum += slopes.terms[k].kept * change.terms[k].kept +
               slopes.terms[k].part * change.terms[k].part;
    return sum;
}

}  // namespace

RelaxationStep relaxation_step(const SolidMaterial& material, double dt_s) {
    RelaxationStep step;
    const double lasting = lasting_part(material, sum_of_amplitudes(material.relaxation));
    step.factor = lasting;
    for (const RelaxationTerm& term : material.relaxation) {
        const double x = dt_s / term.time_s;
        // c_k = a_k (1 - exp(-x)) / x, a_k = g C_k; factor = g + sum c_k (method.md, 9.6)
        const double part = lasting * term.amplitude * mean_left(x);
        step.terms.push_back({std::exp(-x), part});
        step.factor += part;
    }
    return step;
}

RelaxationStep relaxation_step_change(const SolidMaterial& material, double dt_s,
                                      std::span<const RelaxationTerm> change, double dt_change) {
    const double lasting = lasting_part(material, sum_of_amplitudes(material.relaxation));
    // g = 1 / (1 + sum C):  dg = -g^2 sum dC
    const double lasting_change =
        material.is_instantaneous ? -lasting * lasting * sum_of_amplitudes(change) : 0;
    RelaxationStep step;
    step.factor = lasting_change;
    for (std::size_t k = 0; k < material.relaxation.size(); ++k) {
        const RelaxationTerm& term = material.relaxation[k];
        const RelaxationTerm by = change.empty() ? RelaxationTerm{0, 0} : change[k];
        const double x = dt_s / term.time_s, kept = std::exp(-x), mean = mean_left(x);
        // dx = (d dt - x d tau) / tau,  d exp(-x) = -exp(-x) dx,
        // d((1 - e^-x) / x) = (e^-x - (1 - e^-x) / x) / x dx
        const double x_change = (dt_change - x * by.time_s) / term.time_s;
        const double mean_change = (kept - mean) / x * x_change;
        // d(g C) = dg C + g dC
        const double height_change = lasting_change * term.amplitude + lasting * by.amplitude;
        const double part = height_change * mean + lasting * term.amplitude * mean_change;
        step.terms.push_back({-kept * x_change, part});
        step.factor += part;
    }
    return step;
}

void add_term_slopes(const SolidMaterial& material, double dt_s, const RelaxationStep& slopes,
                     std::vector<RelaxationTerm>& sum) {
    std::vector<RelaxationTerm> unit(material.relaxation.size(), RelaxationTerm{0, 0});
    const auto slope = [&] {
        return slope_with(slopes, relaxation_step_change(material, dt_s, unit, 0));
    };
    for (std::size_t k = 0; k < unit.size(); ++k) {
        unit[k] = {1, 0};
        sum[k].amplitude += slope();
        unit[k] = {0, 1};
        sum[k].time_s += slope();
        unit[k] = {0, 0};
    }
}

}  // namespace palpate
