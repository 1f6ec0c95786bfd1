// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/aspiration/sucked_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "host/apps/simulate/surface_profile.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Nominal = AspirationNominal;

constexpr int truth_steps = 144, truth_refine = 2, most_tries = 5;
constexpr double contact_factor = 3000;  // times the stiffness at the peak, a mm

AspirationBody body_of(const AspirationTruth& truth, double travel_mm) {
    AspirationBody body;
    const double radius_mm = 0.5 * Nominal::hole_diameter_mm;
    const double peak_kpa = truth.suction.peak_kpa();
    const double stiffness_kpa = theret_stiffness(peak_kpa, radius_mm, travel_mm);
    body.title = fmt::format("Phantom {}", truth.seed);
    body.hole_diameter_mm = {Nominal::hole_diameter_mm};
    body.edge_radius_mm = {truth.edge_radius_mm};
    body.depth_mm = {Nominal::depth_mm};
    body.outer_diameter_mm = Nominal::outer_diameter_mm;
    body.width_mm = Nominal::width_mm;
    body.rest = cap_surface(truth.cap_mm, radius_mm, truth.edge_radius_mm);
    body.tissue = {
        "veronda-westmann",
        {{"mu_kpa", fmt::format("{:.10g}", truth.mu_kpa)},
         {"gamma", fmt::format("{:.10g}", truth.gamma)}},
        {{fmt::format("{:.10g}", truth.amplitude), fmt::format("{:.10g}", truth.time_s)}}};
    body.kappa_kpa = usual_kappa_over_young * stiffness_kpa;
    body.contact_kpa_per_mm = contact_factor * stiffness_kpa;
    body.peak_kpa = peak_kpa;
    body.steps = suction_steps(truth.suction, truth.film_s, truth_steps);
    body.refine = truth_refine;
    return body;
}

}  // namespace

std::optional<SuckedSurface> sucked_surface(const AspirationBody& body, double begin_s,
                                            const ProgressSink& progress) {
    const SimulationSettings settings =
        parse_simulation(aspiration_model_text(body), "the phantom's model", {});
    SimulationWish wish;
    wish.fills_cells = false;
    const SimulationResult result = run_simulation(settings, progress, wish);
    if (!result.converged()) return std::nullopt;
    Selection surface;
    surface.point_array = "surface";
    const std::vector<Index> nodes = nodes_along(surface, result);
    std::vector<double> time_s;
    std::vector<SmoothCurve> curves;
    // what is beyond hangs over the bore's wall: the curve goes on straight there
    constexpr double beside_the_bore = 0.97;
    const double hole_radius_mm = 0.5 * body.hole_diameter_mm.value;
    for (std::size_t k = 0; k < result.states.size(); ++k) {
        time_s.push_back(begin_s + result.states[k].time_s);
        curves.push_back(
            surface_profile(result, nodes, k, beside_the_bore * hole_radius_mm).height);
    }
    return SuckedSurface(std::move(time_s), std::move(curves));
}

double SuckedSurface::z_mm(double r_mm, double time_s) const {
    const auto after = std::lower_bound(time_s_.begin(), time_s_.end(), time_s);
    if (after == time_s_.begin()) return curves_.front().at(r_mm);
    if (after == time_s_.end()) return curves_.back().at(r_mm);
    const auto k = std::size_t(after - time_s_.begin());
    const double part = (time_s - time_s_[k - 1]) / (time_s_[k] - time_s_[k - 1]);
    const double before = curves_[k - 1].at(r_mm);
    return before + part * (curves_[k].at(r_mm) - before);
}

double SuckedSurface::travel_mm() const {
    double highest = curves_.front().at(0);
    for (const SmoothCurve& curve : curves_) highest = std::max(highest, curve.at(0));
    return highest - curves_.front().at(0);
}

SuckedSurface simulate_aspiration(AspirationTruth& truth, const ProgressSink& progress) {
    constexpr double expected_mm = 1.25;
    for (int k = 0; k < most_tries; ++k) {
        const AspirationBody body = body_of(truth, expected_mm);
        if (auto surface = sucked_surface(body, truth.suction.begin_s(), progress))
            return *std::move(surface);
        for (double& kpa : truth.suction.kpa) kpa *= 0.8;
    }
    throw Error(
        ErrorCode::solve_failed,
        fmt::format("the truth of seed {} has no equilibrium; take another seed", truth.seed));
}

}  // namespace palpate
