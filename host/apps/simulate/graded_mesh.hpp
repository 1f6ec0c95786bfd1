// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// The lower face of a tube about the axis that stands on y = 0, rounded towards its hole: nothing
/// in the hole, level from the edge's end at hole_radius + edge_radius on.
struct TubeFace {
    double hole_radius_mm = 0, edge_radius_mm = 0;

    double end_mm() const { return hole_radius_mm + edge_radius_mm; }
    /// A height at a distance from the axis, kept below the face; in the hole as it is.
    double below(double x_mm, double y_mm) const;
};

/// Quadrilaterals under a surface that something with an edge is set on: a tube, a punch. x runs
/// from the axis (or plane of symmetry), y = 0 is the plane of the edge, the body is below.
struct GradedSettings {
    double width_mm = 0, depth_mm = 0;
    double edge_mm = 0;            ///< x of the finest columns
    std::string edge_of;           ///< the tube whose edge that is; empty: none
    std::optional<TubeFace> face;  ///< of it: the surface is kept below
    int columns_inside = 14, columns_outside = 9, rows = 13;
    int columns_edge = 4;     ///< under the rounded edge of `face`, at equal angles of it
    double finest_mm = 0.25;  ///< height of the first row
    /// The surface at rest: heights y at ascending x, at least three; level beyond the ends. Empty:
    /// y = 0.
    std::vector<double> surface_x_mm, surface_y_mm;
    int coarsen = 1;  ///< of the lines of columns and rows only each so-many-th is kept
    int refine = 1;   ///< what is between two of them is divided in as many
};

/// Whether the surface is given.
bool has_surface(const GradedSettings& graded);

/// The array of a graded mesh that is 1 at nodes of its surface.
inline constexpr const char* graded_surface_array = "surface";

/// Lines of columns come closer toward the edge from both sides; rows grow downward by one factor.
/// The surface's height dies away with depth,
///   y(x, d) = -d + h(x) exp(-d / l) (1 - d / depth),   l = 0.8 edge.
/// All with label 1; nodes of the surface come first, along x. Throws Error(mesh_failed) where an
/// element is folded, saying where, and Error(invalid_argument) for sizes that leave no room.
SolidMesh graded_mesh(const GradedSettings& graded, Formulation formulation);

/// x of the lines of columns, from 0 to the width.
std::vector<double> graded_columns(const GradedSettings& graded);

/// 1 at the nodes of the surface [num_nodes].
std::vector<double> graded_surface(const GradedSettings& graded, const SolidMesh& mesh);

}  // namespace palpate
