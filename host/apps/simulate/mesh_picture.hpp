// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "host/apps/simulate/picture_shape.hpp"

namespace palpate {

/// What a picture of a deformed body shows.
struct MeshPicture {
    std::string quantity;       ///< "displacement, mm"
    std::vector<double> value;  ///< [num_nodes]
    double low = 0, high = 1;   ///< ends of the colour scale
    /// Drawn as outlines, where they are now; seen obliquely only spheres.
    std::vector<Obstacle> obstacles = {};
};

/// The means of the elements round each node, [num_nodes].
std::vector<double> at_nodes(const SolidMesh& mesh, const std::vector<double>& of_elements);

/// Factor that makes displacements of this length visible: 1 unless they are small beside the body.
double enlargement(const SolidMesh& mesh, double largest_mm);

/// A shape of the mesh displaced by `factor` u [3 num_nodes] mm, coloured, as inline SVG with
/// colour scale and scale bar; dashed the outline at rest. Colours of lines and texts come from the
/// style sheet of the page. `id` is the picture's own.
std::string mesh_picture_svg(const SolidMesh& mesh, const PictureShape& shape,
                             const Eigen::VectorXd& u, double factor, const MeshPicture& picture,
                             const std::string& id);

}  // namespace palpate
