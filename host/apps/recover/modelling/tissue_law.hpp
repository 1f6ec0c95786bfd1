// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solver/model/solid_model.hpp"

namespace palpate {

/// The elastic law that all tissue of a body obeys. Both agree at small strains, and the energy of
/// both is proportional to Young's modulus.
enum class TissueLaw {
    linear,       ///< Hooke's law at small strains
    neo_hookean,  ///< compressible neo-Hookean at large deformation
};
/// As the registry of `solver/materials` names it: "linear", "neo-hookean".
const char* name_of(TissueLaw law);
/// Throws Error(invalid_argument) naming those that there are.
TissueLaw tissue_law_of(const std::string& name);

/// The same body with another law.
SolidModel with_law(SolidModel model, TissueLaw law);

/// Of one region of a body that obeys a tissue law.
double stiffness_kpa(const SolidModel& model, Index region);
double poisson_ratio(const SolidModel& model, Index region);
void set_stiffness(SolidModel& model, Index region, double kpa);
void set_poisson_ratio(SolidModel& model, Index region, double ratio);
/// Young's moduli of all regions, kPa.
std::vector<double> moduli_of(const SolidModel& model);

}  // namespace palpate
