// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "solver/model/model.hpp"
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

/// The same body for equilibrium at large deformation.
SolidModel solid_model_of(const Model& model, TissueLaw law);

}  // namespace palpate
