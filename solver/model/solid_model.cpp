// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/solid_model.hpp"

#include <cmath>

#include "solver/materials/registry.hpp"
#include "solver/model/refuse.hpp"

namespace palpate {
namespace {

bool is_on_axis(const SolidMesh& mesh, Index node) {
    return mesh.formulation == Formulation::axisymmetric && mesh.nodes[node].x() == 0;
}

}  // namespace

const char* name_of(RelaxationOf which) {
    return which == RelaxationOf::total ? "total" : "isochoric";
}

RelaxationOf relaxation_of_name(const std::string& name) {
    for (const auto which : {RelaxationOf::total, RelaxationOf::isochoric})
        if (name == name_of(which)) return which;
    refuse("relaxation is of the stress 'isochoric' or 'total', not of '" + name + "'");
}

void check_model(const SolidModel& model) {
    check_mesh(model.mesh);
    for (const SolidMaterial& material : model.materials) {
        check_parameters(material_law(material.law), material.parameters);
        for (const RelaxationTerm& term : material.relaxation) {
            if (term.amplitude >= 0 && std::isfinite(term.amplitude) && term.time_s > 0) continue;
            refuse("a relaxation term of '" + material.law +
                   "' needs an amplitude of 0 or more and a time greater than 0 s");
        }
    }
    for (Index e = 0; e < model.mesh.num_elements(); ++e) {
        if (model.mesh.region[e] < static_cast<Index>(model.materials.size())) continue;
        refuse("element " + std::to_string(e) + " is in region " +
               std::to_string(model.mesh.region[e]) + "; there are materials for " +
               std::to_string(model.materials.size()) + " regions");
    }
    for (const Contact& contact : model.contacts) check_contact(contact, model.mesh);
    for (const PressureSurface& surface : model.pressures)
        check_pressure_surface(surface, model.mesh);
    if (model.prescribed.size() != static_cast<std::size_t>(model.num_dofs())) {
        refuse("the flags of prescribed displacements must be 3 per node");
    }
    if (model.mesh.formulation == Formulation::plane_stress &&
        model.volume == VolumeTreatment::element_mean) {
        refuse("in plane stress the volume follows from the law; it cannot be the element's mean");
    }
    if (model.mesh.formulation == Formulation::solid) return;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        if (!model.prescribed[3 * n + 2]) {
            refuse("node " + std::to_string(n) + " of a plane mesh is free to leave its plane");
        }
        if (is_on_axis(model.mesh, n) && !model.prescribed[3 * n]) {
            refuse("node " + std::to_string(n) + " on the axis is free to leave it");
        }
    }
}

void hold_in_plane(SolidModel& model) {
    if (model.mesh.formulation == Formulation::solid) return;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        model.prescribed[3 * n + 2] = 1;
        if (is_on_axis(model.mesh, n)) model.prescribed[3 * n] = 1;
    }
}

}  // namespace palpate
