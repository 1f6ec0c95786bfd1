// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

#include "host/apps/aspirate/model/aspiration_model.hpp"
#include "host/apps/identify/experiment.hpp"
#include "host/apps/phantom/aspiration/sucked_surface.hpp"

namespace palpate {

/// The scene of the studies of sucked tissue: a cap of 1 mm over a hole of 10 mm, sucked as in the
/// published cycle (rise 3.5 s, hold 3 s, release 3 s, 16 s in all).
struct SuckedScene {
    static constexpr double hole_radius_mm = 5, travel_mm = 1.65, film_s = 16;
    double peak_kpa = 10, kappa_kpa = 1e4, edge_radius_mm = 0.2, friction = 0;
    int num_steps = 48;
    int refine = 1;  ///< of the cells

    /// Young's modulus at the peak, about.
    double stiffness_kpa() const;
    /// What is sucked, but for its tissue.
    AspirationBody body() const;
    static const char* sentence();  ///< for pages
};

/// Writes what is measured into a folder: heights every quarter of a millimetre where the rim does
/// not hide them, at the times that are solved.
///   noise_mm   gives what is added to each
void write_sucked_points(const SuckedSurface& surface, const SuctionSteps& steps, double sd_mm,
                         const std::function<double()>& noise_mm,
                         const std::filesystem::path& folder);

/// The experiment in which the open numbers of a body's tissue are looked for in what was written
/// there.
Experiment sucked_experiment(const AspirationBody& body, const std::filesystem::path& folder);

}  // namespace palpate
