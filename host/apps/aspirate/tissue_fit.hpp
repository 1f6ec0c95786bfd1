// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "host/apps/application.hpp"
#include "host/apps/aspirate/film_outlines.hpp"
#include "host/apps/aspirate/fit_input.hpp"

namespace palpate {

constexpr const char* fit_result_file = "result.json";

/// Of the option `pressure` or of the settings. Throws Error(invalid_argument) if both or neither
/// have it, and what `read_suction` throws.
Suction suction_from(const OptionValues& values, const AspirationSettings& settings);

/// Fits every law with every number of relaxation terms that the settings name and writes the
/// files of the best into a folder.
///   film   what the profiles were found in, for the page; null: tables from elsewhere
Outcome fit_tissue(const AspirationSettings& settings, const Suction& suction,
                   const AspirationFitInput& input, const FilmOutlines* film,
                   const std::filesystem::path& inside, const OptionValues& values,
                   const ProgressSink& progress);

}  // namespace palpate
