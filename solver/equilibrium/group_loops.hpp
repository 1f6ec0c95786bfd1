// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/pack.hpp"
#include "solver/equilibrium/forward_response.hpp"
#include "solver/equilibrium/group_law.hpp"
#include "solver/equilibrium/viscous_step.hpp"
#include "solver/model/solid_geometry.hpp"

// What one group of elements side by side answers, for the processor that it runs on. The functions
// return false, with nothing to be read, where a point is not valid. `element.nodes` are 0, 1, ..;
// u [3 num_nodes of an element].
namespace palpate {

/// The laws of the points, of one material.
struct ElasticGroup {
    using Law = GroupLaw<Pack>;
    Law law;
    const Law& operator()(std::size_t) const { return law; }
};
/// Each with its own history.
struct ViscousGroup {
    using Law = ViscousStep<GroupLaw<Pack>>;
    Law laws[most_element_points];
    const Law& operator()(std::size_t q) const { return laws[q]; }
};

using GroupElement = SolidElement<Pack>;
using GroupChange = ChangeOf<Pack>;

/// As `element_force`.
template <class Laws>
bool group_force(const Laws& laws, const GroupElement& element, const Pack* u, Pack& energy,
                 Pack* force);
/// As `element_tangent`.
template <class Laws>
bool group_tangent(const Laws& laws, const GroupElement& element, const Pack* u, Pack* blocks);
/// df of one change at held displacements after the other, force [changes, num_nodes, 3].
template <class Laws>
bool group_force_changes(const Laws& laws, const GroupElement& element, const Pack* u,
                         std::span<const GroupChange> changes, Pack* force);
/// S of what relaxes, [num_points].
bool group_relaxing_stress(const ViscousGroup& laws, const GroupElement& element, const Pack* u,
                           Tensor3<Pack>* stress);
/// dS of what relaxes for each change and the displacement du [changes, 3 num_nodes] that follows
/// from it, [changes, num_points].
bool group_relaxing_stress_changes(const ViscousGroup& laws, const GroupElement& element,
                                   const Pack* u, const Pack* du,
                                   std::span<const GroupChange> changes, Tensor3<Pack>* stress);

}  // namespace palpate
