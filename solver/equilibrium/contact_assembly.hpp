// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solver/equilibrium/solid_assembly.hpp"

namespace palpate {

/// Where all contacts were when a step began. Empty: at rest, where the model has the obstacles,
/// without friction.
struct ContactStart {
    Eigen::VectorXd displacement;  ///< [3 num_nodes] mm
    std::vector<Vec3> motion;      ///< [contacts] mm, of the obstacles
    std::vector<Vec3> friction;    ///< [contact points] kPa, on the body
};

/// What the obstacles do to the body.
struct ContactState {
    std::vector<Vec3> force;       ///< [contacts] mN, on the body
    std::vector<Vec3> friction;    ///< [contact points] kPa, on the body
    std::vector<double> depth_mm;  ///< [contacts] the deepest of their points; 0 without touch
};

/// Derivatives of a scalar by what a step began with, and by the motion of its obstacles.
struct ContactGradient {
    Eigen::VectorXd displacement_before;  ///< [3 num_nodes] per mm
    std::vector<Vec3> motion_before;      ///< [contacts] per mm
    std::vector<Vec3> motion;             ///< [contacts] per mm
    std::vector<Vec3> friction_before;    ///< [contact points] per kPa
};

/// A direction in what a step's contacts are made of, per unit of one parameter; an empty list
/// means no change.
struct ContactChange {
    Eigen::VectorXd displacement_before;  ///< [3 num_nodes] mm
    std::vector<Vec3> motion_before;      ///< [contacts] mm
    std::vector<Vec3> motion;             ///< [contacts] mm
    std::vector<Vec3> friction_before;    ///< [contact points] kPa
    std::vector<double> coefficient;      ///< [contacts] of friction
    std::vector<Eigen::Vector4d> sizes;   ///< [contacts] mm, in the order of `obstacle_sizes`
    /// [contacts] kPa/mm: of the pressure per depth, and of friction per slip.
    std::vector<Eigen::Vector2d> penalties;
};

/// How a ContactState changes.
struct ContactStateChange {
    std::vector<Vec3> force;     ///< [contacts] mN, on the body
    std::vector<Vec3> friction;  ///< [contact points] kPa, on the body
};

/// The contacts of a SolidModel over one step of a load history: forces and stiffness at the
/// quadrature points of the faces that may touch (`contact_traction`). What friction is limited by
/// is held between two calls of `renew_limits`, so that forces are a gradient and the stiffness is
/// symmetric.
class ContactAssembly {
public:
    /// `model` must outlive this object.
    explicit ContactAssembly(const SolidModel& model);
    ~ContactAssembly();

    bool is_empty() const;
    bool has_friction() const;
    Index num_points() const;
    /// Throws Error(invalid_argument) for sizes that do not fit.
    void begin(const ContactStart& start);
    /// The obstacles' motion now, [contacts] mm or empty. Throws as `begin` does.
    void place(const std::vector<Vec3>& motion);
    /// Limits friction by the pressure at u [3 num_nodes] mm.
    void renew_limits(const Eigen::VectorXd& u);

    /// Adds energy and forces; not valid where a point sits on an axis or in a centre.
    void add_force(const Eigen::VectorXd& u, InternalForce& sum) const;
    /// Adds dF/du with limits held, to a matrix of `SolidAssembly::make_matrix`.
    void add_tangent(const Eigen::VectorXd& u, BlockMatrix& matrix) const;
    /// Adds what the limits' following the pressure adds to dF/du, or the transpose of that.
    void add_limit_rates(const Eigen::VectorXd& u, bool is_transposed, BlockMatrix& matrix) const;
    /// What all contacts can add to the stiffness of each node at most, as if all touched: mN/mm
    /// [num_nodes].
    Eigen::VectorXd largest_stiffness() const;
    /// With limits as the pressure at u has them.
    ContactState state(const Eigen::VectorXd& u) const;

    /// d(slope . friction)/du [3 num_nodes]; slope [contact points].
    Eigen::VectorXd friction_gradient(const Eigen::VectorXd& u,
                                      const std::vector<Vec3>& slope) const;
    /// Derivatives of slope . friction + lambda . (contact force on the body) at a held u.
    ContactGradient start_gradient(const Eigen::VectorXd& u, const Eigen::VectorXd& lambda,
                                   const std::vector<Vec3>& slope) const;

    /// How the contacts' part of the internal force changes at a held u with each of the changes,
    /// limits following the pressure: mN per unit [3 num_nodes, changes].
    Eigen::MatrixXd force_changes(const Eigen::VectorXd& u,
                                  const std::vector<ContactChange>& changes) const;
    /// How `state` changes with u, du [3 num_nodes, changes] mm, and the rest of each change.
    std::vector<ContactStateChange> state_changes(const Eigen::VectorXd& u,
                                                  const Eigen::MatrixXd& du,
                                                  const std::vector<ContactChange>& changes) const;
    /// Derivatives of what `add_force` adds, limits following the pressure, by the sizes of each
    /// obstacle (`obstacle_sizes`) at a held u and a held start of the step: [contacts] matrices
    /// [3 num_nodes, 4], mN/mm.
    std::vector<Eigen::MatrixXd> shape_forces(const Eigen::VectorXd& u) const;

private:
    struct Point;
    struct Slopes;
    struct ShapeSlopes;
    Vec3 at_point(const Point& point, const Eigen::Ref<const Eigen::VectorXd>& u) const;
    Eigen::Matrix<double, 9, 1> start_change(std::size_t point, const ContactChange& change) const;
    static Eigen::Matrix<double, 6, 1> shape_change(const Point& point,
                                                    const ContactChange& change);
    ShapeSlopes shape_slopes_at(const Point& point, const Eigen::VectorXd& u) const;
    Slopes slopes_at(const Point& point, const Eigen::VectorXd& u) const;
    void add_stiffness(const Point& point, const Mat3& stiffness, BlockMatrix& matrix) const;

    const SolidModel& model_;
    std::vector<Point> points_;
    std::vector<Vec3> motion_, motion_before_;
};

}  // namespace palpate
