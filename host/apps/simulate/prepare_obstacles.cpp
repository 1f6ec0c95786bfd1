// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/prepare_obstacles.hpp"

#include <algorithm>

#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/surface_load.hpp"

namespace palpate {
namespace {

constexpr double stiffness_factor = 100;

/// Young's modulus of a sudden small strain.
double modulus_kpa(const SolidMaterial& material) {
    const SmallStrainModuli moduli = small_strain_moduli(material.law, material.parameters);
    if (material.is_instantaneous) return moduli.stiffness_kpa;
    double height = 1;
    for (const RelaxationTerm& term : material.relaxation) height += term.amplitude;
    if (material.relaxation_of == RelaxationOf::total) return height * moduli.stiffness_kpa;
    // G = E / (2 (1 + nu)) is higher, K = E / (3 (1 - 2 nu)) not
    const double shear = moduli.stiffness_kpa / (2 * (1 + moduli.poisson_ratio));
    const double bulk = moduli.stiffness_kpa / (3 * (1 - 2 * moduli.poisson_ratio));
    return moduli_of_shear_and_bulk(height * shear, bulk).stiffness_kpa;
}

/// The stiffest material of elements that have a node of these faces.
double stiffest_kpa(const std::vector<Face>& faces, const SolidMesh& mesh,
                    const std::vector<SolidMaterial>& materials) {
    std::vector<std::uint8_t> is_touched(mesh.nodes.size(), 0);
    for (const Face& face : faces)
        for (const Index node : face) is_touched[node] = 1;
    double stiffest = 0;
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        const auto nodes = mesh.nodes_of(e);
        if (std::any_of(nodes.begin(), nodes.end(), [&](Index n) { return is_touched[n] != 0; }))
            stiffest = std::max(stiffest, modulus_kpa(materials[mesh.region[e]]));
    }
    return stiffest;
}

double mean_edge_mm(const std::vector<Face>& faces, const SolidMesh& mesh) {
    const std::size_t corners = mesh.formulation == Formulation::solid ? 3 : 2;
    double sum = 0;
    for (const Face& face : faces)
        for (std::size_t a = 0; a < corners; ++a)
            sum += (mesh.nodes[face[a]] - mesh.nodes[face[(a + 1) % corners]]).norm();
    return sum / static_cast<double>(corners * faces.size());
}

}  // namespace

Contact contact_of(const ObstacleSettings& settings, const SelectableMesh& in,
                   const std::vector<SolidMaterial>& materials) {
    Contact contact;
    contact.obstacle = settings.obstacle;
    contact.faces = settings.where ? selected_faces(*settings.where, in) : boundary_faces(in.mesh);
    const auto stiffness = [&] {
        return stiffness_factor * stiffest_kpa(contact.faces, in.mesh, materials) /
               mean_edge_mm(contact.faces, in.mesh);
    };
    contact.stiffness_kpa_per_mm =
        settings.stiffness_kpa_per_mm ? *settings.stiffness_kpa_per_mm : stiffness();
    contact.slip_stiffness_kpa_per_mm =
        settings.slip_stiffness_kpa_per_mm.value_or(contact.stiffness_kpa_per_mm);
    contact.friction = settings.friction;
    const bool leaves_axis = has_edge(contact.obstacle.shape) && settings.motion_mm.x() != 0 &&
                             in.mesh.formulation == Formulation::axisymmetric;
    if (leaves_axis)
        settings.source.fail("about an axis a tube or punch moves along it: motion_mm needs x = 0");
    try {
        check_contact(contact, in.mesh);
    } catch (const Error& error) {
        settings.source.fail(error.what());
    }
    return contact;
}

}  // namespace palpate
