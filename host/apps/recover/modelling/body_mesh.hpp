// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/modelling/settings.hpp"
#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/meshing/region_mesh.hpp"
#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// The mesh of the body in the inverse problem, tet4 or tet10, and the region surface that it
/// conforms to: `surface.triangles` are numbers of nodes, and every node that lies in the surface
/// is a corner of them. A face of tet10 is four triangles, through its mid-side nodes. Elements
/// carry region numbers; hollow regions hold none.
struct BodyMesh {
    SolidMesh mesh;
    RegionSurface surface;
};

/// From what meshers give, with mid-side nodes in the middle of the edges if `element` is tet10.
/// Throws Error(invalid_argument) for other elements than tet4 and tet10.
BodyMesh body_mesh(const RegionMesh& mesh, ElementType element = ElementType::tet4);

/// The same body of tet10, with mid-side nodes in the middle of the edges, from one of tet4.
BodyMesh with_mid_side_nodes(const BodyMesh& body);

/// A ready mesh whose `region` holds region numbers, with its conforming surface. tet4 become
/// `element`; tet10 stay what they are, with their mid-side nodes where they are. Faces towards
/// nothing get the hollow organ or the outside that lies there in the reference `field`; faces on
/// the image box are marked.
BodyMesh body_mesh(SolidMesh mesh, const LabelField& field, const Settings& settings,
                   ElementType element = ElementType::tet4);

/// A ready mesh whose `region` holds file labels, with region numbers instead; elements of hollow
/// organs and of unknown labels outside a background without label are left out with their nodes.
/// Throws Error(input_unusable) naming `mesh_name` if no element of a needed organ is left, or one
/// is flat or folded over.
SolidMesh with_region_numbers(SolidMesh labelled, const Settings& settings,
                              const std::string& mesh_name);

/// Element types that `recover` takes, by name. Throws Error(invalid_argument).
ElementType recovery_element_of(const std::string& name);

}  // namespace palpate
