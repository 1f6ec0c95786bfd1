// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// Throws Error(output_failed) if `write_simulation` would refuse `folder`. Call it before the run.
void check_simulation_folder(const std::filesystem::path& folder, bool overwrite);

/// Writes the folder, all or nothing: state_0000.vtu (at rest) and on, simulation.pvd,
/// reactions.csv, simulation.json, report.html. An existing folder is replaced only with
/// `overwrite`, and only if it holds a simulation.json. Throws Error(output_failed).
void write_simulation(const SimulationResult& result, const std::filesystem::path& folder,
                      bool overwrite);

}  // namespace palpate
