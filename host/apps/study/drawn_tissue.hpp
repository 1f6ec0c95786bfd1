// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// The two laws that stiffen. Both have a shear modulus of 2 mu at rest; gamma is how fast the
/// first stiffens, and the second as fast at first: its c2 is mu gamma / 2.
inline constexpr const char* exponential_law = "veronda-westmann";
inline constexpr const char* polynomial_law = "reduced-polynomial";

/// How much stiffer than at rest tissue of such a law is where a hole of `SuckedScene` is sucked
/// full to `travel_mm`, about.
double stiffening(const std::string& law, double gamma, double travel_mm);

/// Tissue that is sucked, and how.
struct DrawnTissue {
    std::string law;
    double mu_kpa = 0, gamma = 0;
    std::vector<std::pair<double, double>> terms;  ///< amplitude, time
    double peak_kpa = 0;                           ///< suction
    double kappa_kpa = 0;                          ///< bulk modulus
};

/// The law goes by whether the seed is even. Drawn are mu (0.2 to 5 kPa), gamma (3 to 25) and the
/// first time (0.5 to 5 s), evenly in the logarithm, one or two relaxation terms, and a travel of 1
/// to 1.6 mm, about, which tells the suction (tissue that had no time to relax comes up by less);
/// again where it would be more than `aspirate` takes. The second time is five times the first, at
/// most the film's length.
DrawnTissue draw_tissue(unsigned seed);

}  // namespace palpate
