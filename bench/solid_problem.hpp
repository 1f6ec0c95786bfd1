// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/fixtures/solid_models.hpp"

namespace palpate::bench {

/// A box of 60 mm, neo-Hookean with a stiff inclusion.
struct SolidSize {
    const char* name;
    bool is_quadratic;
    Index cells;  ///< along each edge, of six tetrahedra
};

constexpr SolidSize small_solid = {"small", false, 4};
constexpr SolidSize seed_size_solid = {"seed_size", false, 18};  ///< 35k tetrahedra
constexpr SolidSize large_solid = {"large", false, 29};          ///< 146k tetrahedra
constexpr SolidSize quadratic_solid = {"tet10", true, 9};

/// The box, compressed by 10 % between plates that hold it.
fixtures::LoadedModel compressed_box(const SolidSize& size);

}  // namespace palpate::bench
