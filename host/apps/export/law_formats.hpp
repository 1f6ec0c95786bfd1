// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/modelling/tissue_law.hpp"
#include "solver/materials/material.hpp"

namespace palpate {

/// How other programs say our laws. All throw Error(unsupported) for a law that a program does not
/// have, naming what to do.
///
/// FEBio's type of material with the parameters E and v.
std::string febio_material_type(const TissueLaw& law);
/// The lines of a *MATERIAL of CalculiX and Abaqus for a region of these moduli; MPa.
std::string calculix_material(const TissueLaw& law, const SmallStrainModuli& moduli);

}  // namespace palpate
