// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/aspiration/aspiration_truth.hpp"

#include <algorithm>
#include <cmath>

#include "host/apps/aspirate/model/aspiration_model.hpp"

namespace palpate {
namespace {

constexpr double reading_s = 0.02;
constexpr double reading_kpa = 0.001;  // that a gauge shows
constexpr double most_kpa = 95;

double log_uniform(RandomNumbers& random, double low, double high) {
    return std::exp(random.uniform(std::log(low), std::log(high)));
}

/// Suction that pulls this tissue by `travel_mm`, about: its stiffness at rest is 6 mu, e^(gamma x)
/// times that where it is stretched, and more where it had no time to relax.
double peak_for(double travel_mm, const AspirationTruth& truth) {
    const double radius_mm = 0.5 * AspirationNominal::hole_diameter_mm;
    const double stretched = 1.3 * std::pow(travel_mm / radius_mm, 2);
    const double e_kpa =
        6 * truth.mu_kpa * std::exp(truth.gamma * stretched) * (1 + 0.5 * truth.amplitude);
    return std::min(most_kpa, e_kpa / theret_stiffness(1, radius_mm, travel_mm));
}

/// A cycle: quiet, up, held, down, quiet again.
Suction cycle(double peak_kpa, double film_s, RandomNumbers& random) {
    const double begin = random.uniform(0.3, 0.6), up = begin + random.uniform(2.5, 4.5),
                 hold = up + random.uniform(2, 4), down = hold + random.uniform(2, 4);
    Suction suction;
    for (int k = 0; double(k) * reading_s < film_s + 0.5; ++k) {
        const double t = double(k) * reading_s;
        const double share =
            std::clamp(std::min((t - begin) / (up - begin), (down - t) / (down - hold)), 0.0, 1.0);
        suction.time_s.push_back(t);
        suction.kpa.push_back(reading_kpa * std::round(peak_kpa * share / reading_kpa));
    }
    return suction;
}

}  // namespace

AspirationTruth draw_aspiration(unsigned seed, bool is_perfect) {
    using Nominal = AspirationNominal;
    AspirationTruth truth;
    truth.seed = seed;
    truth.is_perfect = is_perfect;
    RandomNumbers tissue(0x7475626531ull * 1000003ull + seed);
    truth.mu_kpa = log_uniform(tissue, 0.2, 5);
    truth.gamma = log_uniform(tissue, 1, 25);
    truth.amplitude = log_uniform(tissue, 0.1, 1);
    truth.time_s = log_uniform(tissue, 0.5, 8);
    truth.cap_mm = tissue.uniform(0.8, 1.3);
    const double peak_kpa = peak_for(tissue.uniform(0.9, 1.6), truth);
    truth.suction = cycle(peak_kpa, truth.film_s, tissue);
    truth.scene = {"perfect", 0, 1, 0, 0, 0, 0};
    if (is_perfect) return truth;
    RandomNumbers random(0x7475626532ull * 1000003ull + seed);
    truth.edge_radius_mm = std::clamp(
        Nominal::edge_radius_mm + Nominal::edge_radius_sd_mm * random.normal(), 0.08, 0.4);
    truth.pixel_r_um *= 1 + Nominal::pixel_sd_part * random.normal();
    truth.pixel_z_um *= 1 + Nominal::pixel_sd_part * random.normal();
    truth.delay_s = Nominal::delay_sd_s * random.normal();
    truth.axis_column_px += random.uniform(-2, 2);
    truth.tilt = 0.003 * random.normal();
    truth.jitter_s = 0.002;
    truth.dropped_part = 0.02;
    truth.scene = {"drawn",
                   random.uniform(2, 6),
                   random.uniform(0.8, 1.5),
                   random.uniform(0, 0.4),
                   int(random.uniform(0, 4)),
                   int(random.uniform(0, 3)),
                   int(random.uniform(0, 3))};
    return truth;
}

}  // namespace palpate
