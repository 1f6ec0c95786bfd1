// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solver/model/solid_model.hpp"

namespace palpate {

/// The elastic law that all tissue of a body obeys, one of `solver/materials`. At small strains all
/// are Hooke's law, and the energy of all is proportional to Young's modulus.
struct TissueLaw {
    std::string name = "linear";

    /// Hooke's law at small strains; all others are of large deformation.
    bool is_linear() const { return name == "linear"; }
    bool operator==(const TissueLaw&) const = default;
};
/// Throws Error(invalid_argument) naming those that there are.
TissueLaw tissue_law_of(const std::string& name);
/// "linear", "neo-hookean" and so on.
std::vector<std::string> tissue_law_names();
/// The same in a sentence: "linear (small strains), neo-hookean, ... (large deformation)".
std::string tissue_laws_text();

/// The same body, or material, with another law that has its moduli at small strains; what these
/// leave open is typical of soft tissue.
SolidModel with_law(SolidModel model, const TissueLaw& law);
SolidMaterial with_law(SolidMaterial material, const TissueLaw& law);

/// Moduli at small strains of one region of a body.
double stiffness_kpa(const SolidModel& model, Index region);
double poisson_ratio(const SolidModel& model, Index region);
void set_stiffness(SolidModel& model, Index region, double kpa);
void set_poisson_ratio(SolidModel& model, Index region, double ratio);
/// Young's moduli of all regions, kPa.
std::vector<double> moduli_of(const SolidModel& model);

}  // namespace palpate
