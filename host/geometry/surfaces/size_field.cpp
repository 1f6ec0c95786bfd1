// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

// Chamfer distance: two sweeps, each looking at the 13 neighbours behind it.
std::vector<float> distance_to_organs(const LabelLattice& lattice) {
    const auto& n = lattice.size;
    std::vector<float> distance(lattice.labels.size());
    for (std::size_t cell = 0; cell < distance.size(); ++cell)
        distance[cell] = lattice.labels[cell] >= first_organ_region ? 0.f : 1e9f;
    struct Behind {
        Index i, j, k;
        float length;
    };
    std::vector<Behind> behind;
    for (Index k = -1; k <= 0; ++k)
        for (Index j = -1; j <= (k < 0 ? 1 : 0); ++j)
            for (Index i = -1; i <= (k < 0 || j < 0 ? 1 : -1); ++i)
                behind.push_back(
                    {i, j, k, float(Vec3(i, j, k).cwiseProduct(lattice.spacing).norm())});
    for (const Index direction : {1, -1})
        for (Index kk = 0; kk < n[2]; ++kk)
            for (Index jj = 0; jj < n[1]; ++jj)
                for (Index ii = 0; ii < n[0]; ++ii) {
                    const Index i = direction > 0 ? ii : n[0] - 1 - ii;
                    const Index j = direction > 0 ? jj : n[1] - 1 - jj;
                    const Index k = direction > 0 ? kk : n[2] - 1 - kk;
                    float& here = distance[lattice.offset(i, j, k)];
                    if (here == 0.f) continue;
                    for (const Behind& b : behind) {
                        const Index a = i + direction * b.i, c = j + direction * b.j,
                                    d = k + direction * b.k;
                        if (lattice.is_inside(a, c, d))
                            here = std::min(here, distance[lattice.offset(a, c, d)] + b.length);
                    }
                }
    return distance;
}

}  // namespace

SizeField::SizeField(const LabelLattice& lattice, double edge_length_mm,
                     double outer_edge_length_mm)
    : edge_length_mm_(edge_length_mm),
      outer_edge_length_mm_(outer_edge_length_mm),
      size_(lattice.size),
      spacing_(lattice.spacing),
      distance_(distance_to_organs(lattice)) {}

double SizeField::operator()(const SurfaceComplex& complex, Index vertex) const {
    constexpr double growth = 0.4;  // of the edge length per mm away from organs
    const LabelSet labels = complex.labels_at(vertex);
    if (labels.count > 0 && labels.labels[labels.count - 1] >= first_organ_region)
        return edge_length_mm_;
    std::size_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const Index at = Index(complex.points[vertex][axis] / spacing_[axis]);
        cell = cell * std::size_t(size_[axis]) +
               std::size_t(std::clamp<Index>(at, 0, size_[axis] - 1));
    }
    return std::clamp(edge_length_mm_ + growth * (distance_[cell] - edge_length_mm_),
                      edge_length_mm_, outer_edge_length_mm_);
}

}  // namespace palpate
