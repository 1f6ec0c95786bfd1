// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/surface_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/apps/simulate/selection.hpp"
#include "solver/base/error.hpp"

namespace palpate {

std::vector<Index> nodes_along(const Selection& surface, const SimulationResult& simulation) {
    const SolidMesh& mesh = simulation.mesh();
    const auto chosen = selected_nodes(surface, {mesh, simulation.prepared.point_scalars});
    std::vector<Index> nodes;
    for (Index node = 0; node < mesh.num_nodes(); ++node)
        if (chosen[node]) nodes.push_back(node);
    std::sort(nodes.begin(), nodes.end(),
              [&](Index a, Index b) { return mesh.nodes[a].x() < mesh.nodes[b].x(); });
    return nodes;
}

SurfaceProfile surface_profile(const SimulationResult& simulation, const std::vector<Index>& nodes,
                               std::size_t state, double farthest_mm) {
    const SimulationState& at = simulation.states[state];
    std::vector<double> r, z, rest_r;
    for (const Index node : nodes) {
        const Vec3 place = simulation.mesh().nodes[node] + at.displacement.segment<3>(3 * node);
        if (!r.empty() && !(place.x() > r.back())) {
            if (r.size() > 2 && r.back() >= farthest_mm) break;
            throw Error(ErrorCode::solve_failed,
                        fmt::format("the surface overhangs at {:g} s, {:.3g} mm from the axis: "
                                    "z(r) is no function",
                                    at.time_s, place.x()));
        }
        r.push_back(place.x());
        z.push_back(place.y());
        rest_r.push_back(simulation.mesh().nodes[node].x());
    }
    return {SmoothCurve(r, std::move(z)), SmoothCurve(r, std::move(rest_r))};
}

}  // namespace palpate
