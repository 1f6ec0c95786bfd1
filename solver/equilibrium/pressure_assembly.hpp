// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/model/pressure_surface.hpp"

namespace palpate {

/// One number of a matrix.
struct MatrixEntry {
    Index row = 0, column = 0;
    double value = 0;
};

/// The pressures of a SolidModel that follow its surface. With the area vector c of `DeformedArea`
/// they push on node a, and the load stiffness that they add to the tangent is (Bonet and Wood
/// 2008, section 8.5.2)
///   f_a = -sum P w N_a c(u),      K_ab = -df_a/du_b = sum P w N_a dc/du_b.
/// Where the pressed surfaces are closed, where their edge is prescribed and where it lies on an
/// axis, f is the gradient of minus P times the volume they bound and K is symmetric on the free
/// degrees of freedom; else an antisymmetric part is left, of the nodes on the edge alone. Tangents
/// are therefore kept in two parts: (K + K^T) / 2 for factors, (K - K^T) / 2 for products.
class PressureAssembly {
public:
    /// `model` must outlive this object.
    explicit PressureAssembly(const SolidModel& model);

    bool is_empty() const { return model_.pressures.empty(); }
    /// The pressures now, kPa [model.pressures], or empty: none. Throws Error(invalid_argument) for
    /// another number of them or one that is not finite.
    void set(const std::vector<double>& pressure_kpa);

    /// Takes their forces from `sum.force` and puts their size into it; u [3 num_nodes] mm. The
    /// energy stays as it is: see `work`.
    void add_force(const Eigen::VectorXd& u, InternalForce& sum) const;
    /// The work that the pressures do while the body moves straight from one displacement to
    /// another, mN mm; exact. Along any line its slope is f . du, also where f has no potential.
    double work(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;
    /// Adds (K + K^T) / 2 at u to a matrix of `SolidAssembly::make_matrix`.
    void add_symmetric(const Eigen::VectorXd& u, BlockMatrix& matrix) const;
    /// Adds (K - K^T) / 2 at u, or the transpose of that.
    void add_antisymmetric(const Eigen::VectorXd& u, bool is_transposed, BlockMatrix& matrix) const;
    /// (K - K^T) / 2 at u where it is not zero: at the nodes of open edges.
    ///   negligible  entries up to this size are rounding, mN/mm
    std::vector<MatrixEntry> antisymmetric_entries(const Eigen::VectorXd& u,
                                                   double negligible) const;
    /// lambda . df/dP of each pressure at u, mN mm per kPa [model.pressures]; lambda [3 num_nodes]
    /// mm.
    std::vector<double> products(const Eigen::VectorXd& u, const Eigen::VectorXd& lambda) const;

private:
    std::array<Vec3, 6> places(const Face& face, const Eigen::VectorXd& u) const;
    template <class Visit>
    void for_each_face(const Visit& visit) const;
    template <class Visit>
    void for_each_slope(const Eigen::VectorXd& u, const Visit& visit) const;
    void add_part(const Eigen::VectorXd& u, double of_transpose, double sign,
                  BlockMatrix& matrix) const;

    const SolidModel& model_;
    std::vector<double> pressure_kpa_;
};

/// Throws Error(invalid_argument) unless there is one finite pressure for each surface, or none.
void check_pressures(const SolidModel& model, const std::vector<double>& pressure_kpa);

}  // namespace palpate
