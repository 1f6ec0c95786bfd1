// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/surfaces/surface_complex.hpp"

namespace palpate {

/// Wanted edge length: `edge_length_mm` on organs, growing with the distance from the nearest organ
/// up to `outer_edge_length_mm` on the image box and on the skin.
class SizeField {
public:
    SizeField(const LabelLattice& lattice, double edge_length_mm, double outer_edge_length_mm);

    double operator()(const SurfaceComplex& complex, Index vertex) const;

private:
    double edge_length_mm_, outer_edge_length_mm_;
    std::array<Index, 3> size_;
    Vec3 spacing_;
    std::vector<float> distance_;  ///< mm, cell to nearest organ cell, about 5 % accurate
};

}  // namespace palpate
