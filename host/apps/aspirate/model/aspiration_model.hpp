// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/aspirate/model/aspiration_settings.hpp"
#include "host/apps/aspirate/model/suction.hpp"
#include "host/apps/simulate/simulation_settings.hpp"

namespace palpate {

/// The tissue's surface before suction: heights over the rim's lower face at distances from the
/// axis, ascending from 0; level beyond the last. The model keeps it below the tube.
struct RestSurface {
    std::vector<double> r_mm, z_mm;  ///< at least three
};

/// Numbers of a law and of its relaxation as a model file says them: `0.7`, `"unknown"`, ...
struct TissueText {
    std::string law;
    std::vector<std::pair<std::string, std::string>> parameters;  ///< beside the bulk modulus
    std::vector<std::pair<std::string, std::string>> relaxation;  ///< amplitude, time
};

/// A number that is looked for from `start` on.
std::string open_from(double start);

/// What is sucked, by what, and how.
struct AspirationBody {
    std::string title;
    SettingNumber hole_diameter_mm, edge_radius_mm, depth_mm, friction;
    double outer_diameter_mm = 0, width_mm = 0;
    TissueSide side = TissueSide::slides;
    RestSurface rest;
    TissueText tissue;
    double kappa_kpa = 0;           ///< bulk modulus
    double contact_kpa_per_mm = 0;  ///< pressure of the tube per depth
    double peak_kpa = 0;            ///< suction where its share is 1
    SuctionSteps steps;
    int refine = 1;  ///< of the mesh

    /// What settings say of instrument and tissue; the rest is to be filled in.
    static AspirationBody of(const AspirationSettings& settings);
};

/// The model file that `palpate simulate` runs, or, where numbers are open and [[data]] follow,
/// `palpate identify`: an axisymmetric body under a tube, x from the axis, y = 0 the rim's lower
/// face, suction that follows the surface, time from the begin of suction.
std::string aspiration_model_text(const AspirationBody& body);

/// Makes tissue easier to compress where its bulk modulus is above `most_kpa`.
void limit_bulk_modulus(double most_kpa, SimulationSettings& settings);

/// The surface of a cap: h (1 - (r / radius)^2)^1.25, sampled to where the tube's face is level.
RestSurface cap_surface(double height_mm, double hole_radius_mm, double edge_radius_mm);

/// Young's modulus from how far a suction pulls tissue into a tube (Theret et al. 1988, rim of
/// usual width),
///     E = 3 Phi P a / (2 pi L),   Phi = 2.05.
double theret_stiffness(double suction_kpa, double hole_radius_mm, double travel_mm);

}  // namespace palpate
