// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/apps/simulate/prepared_simulation.hpp"
#include "solver/base/error.hpp"

namespace palpate {

/// Pieces of a small model file.
inline const std::string box_mesh = "[mesh]\nbox = {size_mm = [4, 4, 2], divisions = [2, 2, 1]}\n";
inline const std::string one_material =
    "[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = 10\npoisson_ratio = 0.3\n";
inline const std::string held_base = "[[fix]]\nname = \"base\"\nwhere = {side = \"z-min\"}\n";

inline SimulationSettings parsed(const std::string& toml) {
    return parse_simulation(toml, "model.toml", ".");
}
inline PreparedSimulation prepared(const std::string& toml) {
    return prepare_simulation(parsed(toml));
}

/// Expects that `action` throws an Error of this code whose message holds all the words.
template <class Action>
void expect_refused(Action&& action, const std::vector<std::string>& words,
                    ErrorCode code = ErrorCode::invalid_argument) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
        for (const std::string& word : words)
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
                << "'" << word << "' not in: " << error.what();
        return;
    }
    ADD_FAILURE() << "accepted";
}

}  // namespace palpate
