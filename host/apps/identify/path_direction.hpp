// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/simulate/prepared_simulation.hpp"
#include "solver/sensitivity/history_directions.hpp"

namespace palpate {

/// The direction along an open number of a model file: parameters of laws, amplitudes and times of
/// relaxation, friction above 0, sizes of obstacles and of a mesh that is made here, sizes of
/// loads. Empty for all others, along which whole simulations are compared.
///   moved   the settings with the number larger by so much; asked for loads and shapes alone
std::optional<HistoryDirection> direction_of(
    const std::string& path, const PreparedSimulation& prepared, const SimulationSettings& settings,
    const std::function<SimulationSettings(double by)>& moved);

}  // namespace palpate
