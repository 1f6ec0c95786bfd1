// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/drawn_tissue.hpp"

#include <algorithm>
#include <cmath>

#include "host/apps/phantom/random_numbers.hpp"
#include "host/apps/study/sucked_scene.hpp"

namespace palpate {
namespace {

// of both laws, x = 1.3 (travel / hole radius)^2 where they are stretched
constexpr double stretch_factor = 1.3;
constexpr double most_suction_kpa = most_suction_mbar * kpa_per_mbar;

/// One draw, with whatever suction it takes.
DrawnTissue draw_once(const std::string& law, RandomNumbers& random) {
    const auto evenly_in_ln = [&](double low, double high) {
        return std::exp(random.uniform(std::log(low), std::log(high)));
    };
    DrawnTissue tissue;
    tissue.law = law;
    tissue.mu_kpa = evenly_in_ln(0.2, 5);
    tissue.gamma = evenly_in_ln(3, 25);
    const double first_s = evenly_in_ln(0.5, 5);
    tissue.terms = {{random.uniform(0.2, 0.8), first_s}};
    if (random.is_below(0.5))
        tissue.terms.emplace_back(random.uniform(0.2, 0.8),
                                  std::min(5 * first_s, SuckedScene::film_s));
    const double height_mm = random.uniform(1, 1.6);
    // Young's modulus is 6 mu at rest
    const double stiffness_kpa = 6 * tissue.mu_kpa * stiffening(law, tissue.gamma, height_mm);
    tissue.peak_kpa = stiffness_kpa / theret_stiffness(1, SuckedScene::hole_radius_mm, height_mm);
    tissue.kappa_kpa = usual_kappa_over_young * stiffness_kpa;
    return tissue;
}

}  // namespace

// E is 6 dW/dx, and W = mu (e^(gamma x) - 1) / gamma or mu x + mu gamma x^2 / 2
double stiffening(const std::string& law, double gamma, double travel_mm) {
    const double x = stretch_factor * std::pow(travel_mm / SuckedScene::hole_radius_mm, 2);
    if (law == exponential_law) return std::exp(gamma * x);
    return law == polynomial_law ? 1 + gamma * x : 1;
}

DrawnTissue draw_tissue(unsigned seed) {
    RandomNumbers random(0x5c0ffULL + seed);
    const char* law = seed % 2 == 0 ? exponential_law : polynomial_law;
    DrawnTissue tissue = draw_once(law, random);
    while (tissue.peak_kpa > most_suction_kpa) tissue = draw_once(law, random);
    return tissue;
}

}  // namespace palpate
