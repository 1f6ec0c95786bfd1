// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/mesh/spatial_order.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace palpate {
namespace {

constexpr int bits = 10;  ///< per direction

std::uint32_t spread(std::uint32_t cell) {
    std::uint32_t code = 0;
    for (int bit = 0; bit < bits; ++bit) code |= (cell >> bit & 1u) << (3 * bit);
    return code;
}

}  // namespace

std::vector<Index> spatial_order(const std::vector<Vec3>& points) {
    std::vector<Index> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    if (points.empty()) return order;
    Vec3 low = points.front(), high = points.front();
    for (const Vec3& x : points) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    const double scale = ((1 << bits) - 1) / std::max((high - low).maxCoeff(), 1e-300);
    std::vector<std::uint32_t> codes;
    codes.reserve(points.size());
    for (const Vec3& x : points) {
        const Vec3 cell = scale * (x - low);
        codes.push_back(spread(static_cast<std::uint32_t>(cell[0])) |
                        spread(static_cast<std::uint32_t>(cell[1])) << 1 |
                        spread(static_cast<std::uint32_t>(cell[2])) << 2);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return codes[a] < codes[b]; });
    return order;
}

Mesh renumbered(const Mesh& mesh, const std::vector<Index>& order) {
    Mesh result;
    std::vector<Index> number(mesh.nodes.size());
    result.nodes.reserve(mesh.nodes.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        number[order[k]] = static_cast<Index>(k);
        result.nodes.push_back(mesh.nodes[order[k]]);
    }
    std::vector<Vec3> centroids;
    centroids.reserve(mesh.tets.size());
    for (const Tet& t : mesh.tets)
        centroids.push_back(
            0.25 * (mesh.nodes[t[0]] + mesh.nodes[t[1]] + mesh.nodes[t[2]] + mesh.nodes[t[3]]));
    result.tets.reserve(mesh.tets.size());
    result.region.reserve(mesh.tets.size());
    for (Index t : spatial_order(centroids)) {
        Tet tet = mesh.tets[t];
        for (Index& node : tet) node = number[node];
        result.tets.push_back(tet);
        result.region.push_back(mesh.region[t]);
    }
    return result;
}

}  // namespace palpate
