// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/orientation.hpp"

#include <Eigen/Geometry>
#include <map>
#include <numeric>
#include <utility>

namespace palpate {

OutwardVote::OutwardVote(Index count) : parent_(count), opposed_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
}

OutwardVote::Place OutwardVote::place_of(Index a) {
    Place place{a, false};
    while (parent_[place.root] != place.root) {
        place.opposed ^= opposed_[place.root] != 0;
        place.root = parent_[place.root];
    }
    // Everything on the way hangs at the root from now on.
    bool opposed = place.opposed;
    while (parent_[a] != a) {
        const bool step = opposed_[a] != 0;
        const Index next = std::exchange(parent_[a], place.root);
        opposed_[a] = opposed;
        opposed ^= step;
        a = next;
    }
    return place;
}

void OutwardVote::join(Index a, Index b, bool opposed) {
    const Place of_a = place_of(a), of_b = place_of(b);
    if (of_a.root == of_b.root) return;
    parent_[of_a.root] = of_b.root;
    opposed_[of_a.root] = of_a.opposed ^ of_b.opposed ^ opposed;
}

std::vector<std::uint8_t> OutwardVote::turned(const std::vector<double>& votes) {
    std::vector<double> sum(votes.size(), 0.0);
    std::vector<std::uint8_t> turned(votes.size());
    const Index count = static_cast<Index>(votes.size());
    for (Index a = 0; a < count; ++a) {
        const Place place = place_of(a);
        sum[place.root] += place.opposed ? -votes[a] : votes[a];
    }
    for (Index a = 0; a < count; ++a) {
        const Place place = place_of(a);
        turned[a] = place.opposed != (sum[place.root] < 0);
    }
    return turned;
}

Surface oriented_outward(Surface surface, const Outward& outward) {
    const Index count = static_cast<Index>(surface.triangles.size());
    OutwardVote vote(count);
    std::map<std::pair<Index, Index>, std::pair<Index, bool>> first;  // triangle, as it runs there
    std::vector<double> votes;
    for (Index t = 0; t < count; ++t) {
        const Triangle& corner = surface.triangles[t];
        for (int c = 0; c < 3; ++c) {
            const Index from = corner[c], to = corner[(c + 1) % 3];
            const auto [at, is_new] =
                first.try_emplace(std::minmax(from, to), std::pair(t, from < to));
            // Two triangles that agree run along their edge in opposite directions.
            if (!is_new) vote.join(t, at->second.first, at->second.second == (from < to));
        }
        const Vec3& a = surface.vertices[corner[0]];
        const Vec3 b = surface.vertices[corner[1]] - a, c = surface.vertices[corner[2]] - a;
        votes.push_back(b.cross(c).dot(outward(a + (b + c) / 3).normalized()));
    }
    const auto turned = vote.turned(votes);
    for (Index t = 0; t < count; ++t) {
        if (turned[t]) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    }
    return surface;
}

}  // namespace palpate
