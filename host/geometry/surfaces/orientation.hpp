// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

/// About the outward direction of an organ near a point of space (mm LPS), of any length. It need
/// not be right everywhere: the pieces of a shape are turned by the majority of their points.
using Outward = std::function<Vec3(const Vec3&)>;

/// Which of many normals must be turned round so that neighbours agree and most of each connected
/// piece points outward (Hoppe et al. 1992, section 3.3, with a vote instead of an extreme point).
class OutwardVote {
public:
    explicit OutwardVote(Index count);
    /// Puts a and b into one piece; `opposed`: one must be turned to agree with the other. Joins
    /// inside a piece change nothing, so the first ones count.
    void join(Index a, Index b, bool opposed);
    /// `votes` [count]: positive where the normal points outward as it is. [count] 1: turn it.
    std::vector<std::uint8_t> turned(const std::vector<double>& votes);

private:
    /// The piece of `a`, named by one member, and whether `a` is opposed to that.
    struct Place {
        Index root;
        bool opposed;
    };
    Place place_of(Index a);

    std::vector<Index> parent_;
    std::vector<std::uint8_t> opposed_;  ///< to the parent
};

/// The same surface with its triangles counter-clockwise seen from outside.
Surface oriented_outward(Surface surface, const Outward& outward);

}  // namespace palpate
