// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// The state that pictures and numbers show: the last of those that are displaced the most.
std::size_t shown_state(const SimulationResult& result);
/// Its time in words: "at 3 s", "at full load", "at 40 % of the load".
std::string time_text(const SimulationResult& result, double time_s);

/// The longest displacement of a state, mm, and the node that has it.
struct LargestDisplacement {
    double length_mm = 0;
    Index node = 0;
};
LargestDisplacement largest_displacement(const SimulationState& state);

/// The largest resultant of a holder over all states.
struct LargestForce {
    double size_mn = 0;
    std::size_t state = 0;
};
LargestForce largest_force(const SimulationResult& result, std::size_t holder);

/// Undeformed volume of an element set and what became of it in a state.
struct VolumeChange {
    double before_mm3 = 0, after_mm3 = 0;
    double percent() const { return 100 * (after_mm3 / before_mm3 - 1); }
};
VolumeChange volume_change(const SimulationResult& result, const SimulationState& state);

int num_newton_steps(const SimulationResult& result);

/// What was found and whether all steps converged, for people.
std::string convergence_sentence(const SimulationResult& result);
std::vector<std::string> simulation_sentences(const SimulationResult& result);

}  // namespace palpate
