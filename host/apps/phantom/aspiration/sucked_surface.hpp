// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "host/apps/aspirate/model/aspiration_model.hpp"
#include "host/apps/phantom/aspiration/aspiration_truth.hpp"
#include "host/apps/simulate/smooth_curve.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Heights of a sucked surface over the rim's face; between times that were solved on a straight
/// line, and before them at rest.
class SuckedSurface {
public:
    SuckedSurface(std::vector<double> time_s, std::vector<SmoothCurve> curves)
        : time_s_(std::move(time_s)), curves_(std::move(curves)) {}

    /// At distances from the axis and times of the readings of suction.
    double z_mm(double r_mm, double time_s) const;
    double travel_mm() const;  ///< of the axis

private:
    std::vector<double> time_s_;  ///< ascending, the first at rest
    std::vector<SmoothCurve> curves_;
};

/// What a body's surface does under its suction, which begins at `begin_s`; empty where there is no
/// equilibrium.
std::optional<SuckedSurface> sucked_surface(const AspirationBody& body, double begin_s,
                                            const ProgressSink& progress);

/// Solves the truth on cells and time steps of half the size of those that a fit has by default.
/// Lowers the suction by a fifth, up to four times, where there is no equilibrium; then throws
/// Error(solve_failed).
SuckedSurface simulate_aspiration(AspirationTruth& truth, const ProgressSink& progress);

}  // namespace palpate
