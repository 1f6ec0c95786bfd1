// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/geometry/fields/label_field.hpp"

namespace palpate {

/// The body with the mid-side nodes of its surfaces moved onto the interfaces of `field`, so that
/// faces curve as the organs do; tet4 stay as they are. Nodes of elements that this would crush
/// (a linear piece below a third of its volume) stay in the middle of their edges, and so do those
/// on the box and where three regions meet.
/// Corners stay where they are: those of `extract_surfaces` lie up to l^2 / (8 R) outside.
///   field  has the body's regions
BodyMesh curved_along(const LabelField& field, BodyMesh body);

}  // namespace palpate
