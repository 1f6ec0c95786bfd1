// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solver/model/contact.hpp"
#include "solver/model/pressure_surface.hpp"
#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// One term of a reduced relaxation function: after a sudden strain the stress that relaxes exceeds
/// its long-term value by the part amplitude exp(-t / time).
struct RelaxationTerm {
    double amplitude = 0;  ///< >= 0, of the long-term stress
    double time_s = 1;     ///< > 0
};

/// Which stress relaxes.
enum class RelaxationOf {
    total,      ///< all of it, pressure included: not stable where C p outweighs the shear modulus
    isochoric,  ///< that of the changes of shape (`isochoric_part`); the volume stays elastic
};
/// "total", "isochoric".
const char* name_of(RelaxationOf which);
/// Throws Error(invalid_argument) naming those that there are.
RelaxationOf relaxation_of_name(const std::string& name);

/// A law of the registry with its parameters, in the order of its description.
struct SolidMaterial {
    std::string law;  ///< "neo-hookean"
    std::vector<double> parameters;
    std::vector<RelaxationTerm> relaxation = {};  ///< empty: elastic
    RelaxationOf relaxation_of = RelaxationOf::total;
    /// The law is that of a sudden strain: the stress that relaxes ends at 1 / (1 + sum of
    /// amplitudes) of it. Otherwise it is the long-term one.
    bool is_instantaneous = false;
};

/// How the change of volume enters the laws.
enum class VolumeTreatment {
    pointwise,     ///< as the displacement has it at each point; locks near incompressibility
    element_mean,  ///< its mean over the element: tet10 and quad4 do not lock
};

/// Everything that equilibrium at large deformation needs to know, but the loads.
struct SolidModel {
    SolidMesh mesh;
    std::vector<SolidMaterial> materials;  ///< indexed by `mesh.region`
    std::vector<std::uint8_t> prescribed;  ///< [3 num_nodes], 1 where the displacement is given
    VolumeTreatment volume = VolumeTreatment::pointwise;
    std::vector<Contact> contacts = {};
    std::vector<PressureSurface> pressures = {};  ///< that follow the surface they act on

    Index num_dofs() const { return 3 * mesh.num_nodes(); }
};

/// Throws Error(invalid_argument) naming the first broken rule: those of `check_mesh`, laws and
/// parameters, regions without material, contacts, pressed surfaces, the size of `prescribed`, in a
/// plane a third component that is not prescribed, and a mean volume in plane stress, where the law
/// sets it.
void check_model(const SolidModel& model);

/// Prescribes the third component of every node of a plane mesh, and the distance from the axis of
/// the nodes on it.
void hold_in_plane(SolidModel& model);

}  // namespace palpate
