// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/surfaces/label_lattice.hpp"

namespace palpate {

/// A small sorted set of region labels; what meets at a vertex.
struct LabelSet {
    std::array<std::uint8_t, 8> labels{};
    int count = 0;

    void insert(std::uint8_t label);
    std::span<const std::uint8_t> view() const { return {labels.data(), std::size_t(count)}; }
};

/// The triangle complex between all regions while it is being worked on, in the image's own frame
/// (see `LabelLattice`). Edges may have more than two faces (where three regions meet) and faces
/// change plane on the box's edges: those edges are features. Dead faces have v[0] = -1.
struct SurfaceComplex {
    struct Face {
        std::array<Index, 3> v{-1, -1, -1};
        std::array<std::uint8_t, 2> regions{0, 0};  ///< behind < in front (`beyond_box` outside)
        std::int8_t plane = -1;                     ///< box plane 2 axis + (0 low, 1 high), or -1

        bool is_alive() const { return v[0] >= 0; }
        bool has(Index vertex) const { return v[0] == vertex || v[1] == vertex || v[2] == vertex; }
    };
    /// What a vertex may do: move on its surface, along its curve, or stay.
    enum class Kind { surface, curve, corner };
    struct FeatureNeighbours {
        std::array<Index, 8> vertices{};
        int count = 0;
    };

    std::vector<Vec3> points;
    std::vector<std::uint8_t> planes;  ///< per vertex: bit p set if it lies on box plane p
    std::vector<Face> faces;
    std::vector<std::vector<Index>> faces_of;  ///< per vertex: its living faces

    void connect();  ///< fills `faces_of`
    void compact();  ///< drops dead faces and unused vertices

    /// Area vector of a face (twice the area), optionally with one vertex put elsewhere.
    Vec3 area_vector(const Face& face) const;
    Vec3 area_vector(const Face& face, Index moved, const Vec3& to) const;

    /// Faces at the edge (u, v), at most 8; returns their number.
    int edge_faces(Index u, Index v, std::array<Index, 8>& found) const;
    bool is_feature(Index u, Index v) const;
    /// The kind of a vertex, and its neighbours along feature edges (at most 8; two on a curve).
    Kind kind(Index vertex, FeatureNeighbours* along = nullptr) const;
    /// The labels inside the box that meet at a vertex.
    LabelSet labels_at(Index vertex) const;
    /// Bit a set if the vertex may not move along axis a.
    unsigned fixed_axes(Index vertex) const;
    /// All edges (u < v), each once.
    std::vector<std::array<Index, 2>> edges() const;
};

/// The faces between cells of different labels, each square cut in two, vertices on cell corners.
SurfaceComplex boundary_of(const LabelLattice& lattice);

/// Smallest angle of a triangle, as its cosine (1: degenerate). Cheap stand-in for the angle.
double largest_cosine(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace palpate
