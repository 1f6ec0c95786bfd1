// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/simulation_findings.hpp"

#include <fmt/format.h>

#include "host/page/numbers.hpp"
#include "host/page/plain_text.hpp"

namespace palpate {

LargestDisplacement largest_displacement(const SimulationState& state) {
    LargestDisplacement largest;
    for (Eigen::Index n = 0; 3 * n < state.displacement.size(); ++n) {
        const double length = state.displacement.segment<3>(3 * n).norm();
        if (length > largest.length_mm) largest = {length, static_cast<Index>(n)};
    }
    return largest;
}

std::size_t shown_state(const SimulationResult& result) {
    constexpr double as_good_as_largest = 0.999;
    std::vector<double> lengths;
    for (const SimulationState& state : result.states)
        lengths.push_back(largest_displacement(state).length_mm);
    const double largest = *std::max_element(lengths.begin(), lengths.end());
    std::size_t shown = lengths.size() - 1;
    while (lengths[shown] < as_good_as_largest * largest) --shown;
    return shown;
}

std::string time_text(const SimulationResult& result, double time_s) {
    if (!result.prepared.is_static) return fmt::format("at {} s", significant(time_s));
    if (time_s == 1) return "at full load";
    return fmt::format("at {} % of the load", significant(100 * time_s));
}

LargestForce largest_force(const SimulationResult& result, std::size_t holder) {
    LargestForce largest;
    for (std::size_t k = 0; k < result.states.size(); ++k) {
        const double size = result.states[k].force_mn[holder].norm();
        if (size > largest.size_mn) largest = {size, k};
    }
    return largest;
}

VolumeChange volume_change(const SimulationResult& result, const SimulationState& state) {
    VolumeChange change;
    for (std::size_t e = 0; e < result.element_volume_mm3.size(); ++e) {
        change.before_mm3 += result.element_volume_mm3[e];
        change.after_mm3 += result.element_volume_mm3[e] * state.cells.volume_ratio[e];
    }
    return change;
}

int num_newton_steps(const SimulationResult& result) {
    std::size_t count = 0;
    for (const SimulationStep& step : result.steps) count += step.records.size();
    return static_cast<int>(count);
}

std::string convergence_sentence(const SimulationResult& result) {
    const SimulationStep& last = result.steps.back();
    if (last.converged && result.settings.dynamics)
        return fmt::format(
            "The motion was followed to its end: {:.0f} steps of at most {} s, {} s.",
            result.num_explicit_steps, significant(result.longest_explicit_step_s),
            significant(result.seconds));
    if (last.converged)
        return fmt::format("{} in equilibrium: {} {}, {} Newton steps, {} s.",
                           result.steps.size() == 1 ? "The body is" : "All states are",
                           result.steps.size(), result.steps.size() == 1 ? "step" : "steps",
                           num_newton_steps(result), significant(result.seconds));
    return fmt::format(
        "It did NOT converge: step {} of {} reached {} only ({}). What was reached is written; "
        "make "
        "the load smaller, its steps shorter or the mesh finer.",
        result.steps.size(), result.prepared.time_s.size(),
        time_text(result, last.reached_s).substr(3), last.message);
}

std::vector<std::string> simulation_sentences(const SimulationResult& result) {
    const SimulationState& state = result.states[shown_state(result)];
    const LargestDisplacement largest = largest_displacement(state);
    std::vector<std::string> sentences;
    sentences.push_back(fmt::format("Largest displacement {} mm, {}.",
                                    significant(largest.length_mm),
                                    time_text(result, state.time_s)));
    for (std::size_t k = 0; k < result.num_holders(); ++k) {
        const LargestForce force = largest_force(result, k);
        const Vec3& f = result.states[force.state].force_mn[k];
        sentences.push_back(
            fmt::format("Force of '{}' on the body: up to {} mN ({}), as a vector ({}, {}, {}) mN.",
                        harmless(result.holder_name(k)), significant(force.size_mn),
                        time_text(result, result.states[force.state].time_s), significant(f.x()),
                        significant(f.y()), significant(f.z())));
    }
    sentences.push_back(convergence_sentence(result));
    return sentences;
}

}  // namespace palpate
