// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "solver/model/model.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// The same body of linear tetrahedra; every material has `law`, of the registry, with the same
/// moduli at small strains.
SolidModel solid_model_of(const Model& model, const std::string& law = "linear");

/// Whether `Model` can say the same: linear tetrahedra of the law "linear" and nothing else.
bool is_linear_tet4(const SolidModel& model);
/// The same as a `Model`. Throws Error(invalid_argument) unless `is_linear_tet4`.
Model tet4_model_of(const SolidModel& model);

}  // namespace palpate
