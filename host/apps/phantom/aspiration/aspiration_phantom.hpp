// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "host/apps/phantom/aspiration/aspiration_truth.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct AspirationPhantomOptions {
    unsigned seed = 1;
    bool is_perfect = false;
    bool is_png = false;  ///< frames; else PGM
};

/// What a phantom says of itself.
struct AspirationFigures {
    AspirationTruth truth;
    double travel_mm = 0;
    Index num_frames = 0;
};

/// Makes a folder: frames/, times.csv, pressure.csv and aspiration.toml, which `palpate aspirate`
/// takes; truth.json; profiles_true.csv, what contours without any error would be. Throws
/// Error(solve_failed), Error(output_failed).
AspirationFigures make_aspiration_phantom(const AspirationPhantomOptions& options,
                                          const std::filesystem::path& folder,
                                          const ProgressSink& progress);

}  // namespace palpate
