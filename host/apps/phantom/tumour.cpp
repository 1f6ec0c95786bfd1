// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/tumour.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace palpate {
namespace {

Vec3 centroid(const Mesh& mesh, Index tet) {
    Vec3 sum = Vec3::Zero();
    for (const Index node : mesh.tets[tet]) sum += mesh.nodes[node];
    return 0.25 * sum;
}

}  // namespace

Vec3 tumour_centre(const OrganShape& prostate, unsigned seed) {
    const double side = seed % 2 == 0 ? 1 : -1;
    const Vec3 in_own_axes = Vec3(0.45 * side, 0.4, -0.2).cwiseProduct(prostate.semi_axes);
    return prostate.centre + prostate.axes * in_own_axes;
}

double mark_ball(Mesh& mesh, Index region, Index new_region, const Vec3& centre, double fraction) {
    std::vector<std::pair<double, Index>> by_distance;
    double volume = 0;
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        if (mesh.region[t] != region) continue;
        by_distance.emplace_back((centroid(mesh, t) - centre).norm(), t);
        volume += tet_volume(mesh, t);
    }
    std::sort(by_distance.begin(), by_distance.end());
    double filled = 0;
    for (const auto& [distance, tet] : by_distance) {
        if (filled + 0.5 * tet_volume(mesh, tet) > fraction * volume) break;
        mesh.region[tet] = new_region;
        filled += tet_volume(mesh, tet);
    }
    return volume > 0 ? filled / volume : 0;
}

}  // namespace palpate
