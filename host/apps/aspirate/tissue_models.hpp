// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "host/apps/application.hpp"
#include "host/apps/aspirate/fit_page.hpp"
#include "host/estimate/parameter.hpp"

namespace palpate {

/// What no residual shows of the tissue's numbers, an sd on their logarithms [num_parameter], 0 for
/// others: outlines near the wall, the guess of the rest, contact at the rim.
Eigen::VectorXd model_sds(const std::vector<Parameter>& parameters);

/// Fits every law with every number of relaxation terms that the settings name, as far as it takes
/// to tell which is the best. Intervals by profiles and the mesh check are of the best alone.
///   inside   the folder that the points are in
/// Throws what a search throws.
AspirationFit fit_models(const AspirationSettings& settings, const AspirationFitInput& input,
                         const Suction& suction, const std::filesystem::path& inside,
                         const OptionValues& values, const ProgressSink& progress);

}  // namespace palpate
