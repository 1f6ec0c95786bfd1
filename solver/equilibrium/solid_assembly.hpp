// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solver/base/tensor3.hpp"
#include "solver/equilibrium/element_loops.hpp"
#include "solver/equilibrium/solid_change.hpp"
#include "solver/model/block_matrix.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// What a displacement stores and how it pushes back.
struct InternalForce {
    double energy = 0;          ///< mN mm; infinite if not valid
    Eigen::VectorXd force;      ///< [3 num_nodes] mN, dW/du
    bool is_valid = true;       ///< false where matter is inverted at any point
    double contact_force = 0;   ///< norm of what obstacles add to `force`, mN
    double pressure_force = 0;  ///< norm of what following pressures add to `force`, mN
};

/// Derivatives of a scalar by what a viscous step is made of, displacements held.
struct ViscousSlopes {
    std::vector<Tensor3<double>> prestress;       ///< [num_elements, num_points] per kPa
    std::vector<double> factor;                   ///< [materials]
    std::vector<std::vector<double>> parameters;  ///< [materials][parameters]
};

/// What one quadrature point goes through.
struct PointState {
    Tensor3<double> gradient;  ///< H as its law has it (mean volume, plane stress)
    Tensor3<double> stress;    ///< first Piola, kPa, that the forces are made of; 0 if not valid
    double volume = 0;         ///< undeformed, mm^3
};

struct AssemblyTables;

/// Energy, forces and stiffness of a SolidModel at a displacement (total Lagrangian: all integrals
/// over the undeformed mesh), in fp64. Forces, tangents and parameter products of the laws alone
/// run where `ElementLoopOptions` says; the rest, and everything during a viscous step, on the
/// host, where threads go through `element_parts`, so that sums have a fixed order.
class SolidAssembly {
public:
    /// Copies the model. Throws Error(invalid_argument) as `check_model` and `point_geometry` do,
    /// and as `ElementLoops`.
    explicit SolidAssembly(const SolidModel& model, const ElementLoopOptions& loops = {});
    ~SolidAssembly();

    const SolidModel& model() const;
    /// Who runs the element loops.
    const ElementLoopInfo& loops() const;
    /// u [3 num_nodes] mm.
    InternalForce internal_force(const Eigen::VectorXd& u) const;
    /// From now on materials with relaxation answer as `ViscousStep` says; at first as their laws.
    ///   factor     [materials]
    ///   prestress  [num_elements, num_points] second Piola, kPa
    void set_viscous_step(std::vector<double> factor, std::vector<Tensor3<double>> prestress);
    /// Second Piola stresses of what relaxes (`RelaxationOf`) at u, without what earlier steps
    /// left, kPa [num_elements, num_points]; zero for materials without relaxation.
    std::vector<Tensor3<double>> relaxing_stress(const Eigen::VectorXd& u) const;

    /// All points at u, [num_elements, num_points], for reports.
    std::vector<PointState> point_states(const Eigen::VectorXd& u) const;

    /// A matrix of the right pattern, all zeros.
    BlockMatrix make_matrix() const;
    /// K = dF/du at u into a matrix of `make_matrix`, mN/mm, without regard to prescribed dofs;
    /// symmetric. Points that are not valid add nothing.
    void tangent(const Eigen::VectorXd& u, BlockMatrix& matrix) const;
    /// lambda . df/dp at u for every parameter p of every material: [materials][parameters], mN mm
    /// per unit of the parameter. lambda [3 num_nodes] mm.
    std::vector<std::vector<double>> parameter_products(const Eigen::VectorXd& u,
                                                        const Eigen::VectorXd& lambda) const;
    /// df/dp at u: one matrix [3 num_nodes, parameters] per material, mN per unit of the parameter.
    std::vector<Eigen::MatrixXd> parameter_forces(const Eigen::VectorXd& u) const;
    /// Derivative by u of the sum over points of slope : S, S as `relaxing_stress` has it; [3
    /// num_nodes].
    Eigen::VectorXd relaxing_stress_gradient(const Eigen::VectorXd& u,
                                             const std::vector<Tensor3<double>>& slope) const;
    /// Derivatives of (sum over points of slope : S) - lambda . f, f the internal force, at a held
    /// u.
    ViscousSlopes viscous_slopes(const Eigen::VectorXd& u, const Eigen::VectorXd& lambda,
                                 const std::vector<Tensor3<double>>& slope) const;
    /// df at a held u for each of the changes, mN per unit [3 num_nodes, changes].
    Eigen::MatrixXd force_changes(const Eigen::VectorXd& u,
                                  const std::vector<SolidChange>& changes) const;
    /// How `relaxing_stress` changes with the displacements, du [3 num_nodes, changes] mm, and the
    /// rest of each change: kPa per unit [changes][num_elements, num_points].
    std::vector<std::vector<Tensor3<double>>> relaxing_stress_changes(
        const Eigen::VectorXd& u, const Eigen::MatrixXd& du,
        const std::vector<SolidChange>& changes) const;

private:
    std::unique_ptr<AssemblyTables> tables_;
};

}  // namespace palpate
