// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/contact_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <unsupported/Eigen/AutoDiff>

#include "solver/base/error.hpp"
#include "solver/equilibrium/add_block.hpp"
#include "solver/equilibrium/contact_traction.hpp"

namespace palpate {
namespace {

/// By the four sizes of an obstacle, then its two penalties.
using ShapeDual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 6, 1>>;

ObstacleSizes<ShapeDual> size_variables(const Obstacle& obstacle) {
    ObstacleSizes<ShapeDual> sizes(obstacle);
    ShapeDual* list[] = {&sizes.radius, &sizes.edge_radius, &sizes.outer_radius,
                         &sizes.outer_edge_radius};
    for (int k = 0; k < 4; ++k) *list[k] = ShapeDual(list[k]->value(), 6, k);
    return sizes;
}

ContactPenalties<ShapeDual> penalty_variables(const Contact& contact) {
    ContactPenalties<ShapeDual> penalties(contact);
    penalties.stiffness = ShapeDual(penalties.stiffness.value(), 6, 4);
    penalties.slip_stiffness = ShapeDual(penalties.slip_stiffness.value(), 6, 5);
    return penalties;
}

Triple<ShapeDual> constants(const Vec3& v) {
    return {ShapeDual(v[0]), ShapeDual(v[1]), ShapeDual(v[2])};
}

/// By y, y_before and friction_before.
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 9, 1>>;
using Rates = Eigen::Matrix<double, 3, 9>;

Triple<double> numbers(const Vec3& v) { return {v[0], v[1], v[2]}; }

Triple<Dual> variables(const Vec3& v, int first) {
    Triple<Dual> result;
    // v_i with the derivative 1 by variable first + i of nine
    for (int i = 0; i < 3; ++i) result[i] = Dual(v[i], 9, first + i);
    return result;
}

Vec3 values(const Triple<double>& v) { return {v[0], v[1], v[2]}; }

Rates rates(const Triple<Dual>& v) {
    Rates result;
    for (int i = 0; i < 3; ++i) result.row(i) = v[i].derivatives().transpose();
    return result;
}

}  // namespace

struct ContactAssembly::Point {
    std::size_t contact = 0;  ///< its number in the model
    const Face* face = nullptr;
    std::array<double, 6> value{};
    double area = 0;
    Vec3 place = Vec3::Zero();         ///< undeformed
    Vec3 place_before = Vec3::Zero();  ///< when the step began, in the obstacle's frame
    Vec3 friction_before = Vec3::Zero();
    double limit = 0;  ///< of friction, kPa
};

/// What a point's traction depends on, and how.
struct ContactAssembly::Slopes {
    Rates traction;  ///< pressure and friction
    Rates friction;
    Vec3 by_coefficient;  ///< of friction
};

/// How a point's traction depends on the sizes and penalties of its obstacle.
struct ContactAssembly::ShapeSlopes {
    Eigen::Matrix<double, 3, 6> traction, friction;
};

ContactAssembly::ContactAssembly(const SolidModel& model) : model_(model) {
    for (std::size_t c = 0; c < model.contacts.size(); ++c)
        for (const Face& face : model.contacts[c].faces)
            for (const FacePoint& from : face_points(model.mesh, face)) {
                Point point;
                point.contact = c;
                point.face = &face;
                point.value = from.value;
                point.area = from.area;
                point.place = from.place;
                points_.push_back(point);
            }
    begin({});
}

ContactAssembly::~ContactAssembly() = default;

bool ContactAssembly::is_empty() const { return points_.empty(); }

Index ContactAssembly::num_points() const { return static_cast<Index>(points_.size()); }

bool ContactAssembly::has_friction() const {
    return std::any_of(model_.contacts.begin(), model_.contacts.end(),
                       [](const Contact& contact) { return contact.friction > 0; });
}

Vec3 ContactAssembly::at_point(const Point& point,
                               const Eigen::Ref<const Eigen::VectorXd>& u) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t a = 0; a < point.face->size(); ++a)
        // u(x) = sum N_a u_a
        sum += point.value[a] * u.segment<3>(3 * (*point.face)[a]);
    return sum;
}

void ContactAssembly::place(const std::vector<Vec3>& motion) {
    const std::size_t count = model_.contacts.size();
    if (!motion.empty() && motion.size() != count)
        throw Error(ErrorCode::invalid_argument,
                    "obstacles move by one vector each: " + std::to_string(count) + ", not " +
                        std::to_string(motion.size()));
    for (const Vec3& by : motion)
        if (!by.allFinite())
            throw Error(ErrorCode::invalid_argument,
                        "the motion of an obstacle is not a finite number");
    motion_ = motion;
    motion_.resize(count, Vec3::Zero());
}

void ContactAssembly::begin(const ContactStart& start) {
    place(start.motion);
    motion_before_ = motion_;
    if (!start.friction.empty() && start.friction.size() != points_.size())
        throw Error(ErrorCode::invalid_argument,
                    "the friction that a step begins with has " +
                        std::to_string(start.friction.size()) + " vectors for " +
                        std::to_string(points_.size()) + " contact points");
    for (std::size_t k = 0; k < points_.size(); ++k) {
        Point& point = points_[k];
        // y = X + u - motion: seen from the obstacle, one that moves needs no formulas of its own.
        point.place_before = point.place - motion_before_[point.contact];
        if (start.displacement.size() > 0)
            point.place_before += at_point(point, start.displacement);
        point.friction_before = start.friction.empty() ? Vec3::Zero() : start.friction[k];
        point.limit = 0;
    }
    if (start.displacement.size() > 0) renew_limits(start.displacement);
}

void ContactAssembly::renew_limits(const Eigen::VectorXd& u) {
    for (Point& point : points_) {
        const Contact& contact = model_.contacts[point.contact];
        const Vec3 y = point.place + at_point(point, u) - motion_[point.contact];
        const double depth = depth_in(contact.obstacle, numbers(y)).depth;
        // limit = mu p,  p = k <depth> (method.md, 9.8)
        point.limit = contact.friction * contact.stiffness_kpa_per_mm * std::max(0.0, depth);
    }
}

void ContactAssembly::add_force(const Eigen::VectorXd& u, InternalForce& sum) const {
    if (is_empty() || !sum.is_valid) return;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(u.size());
    for (const Point& point : points_) {
        const Contact& contact = model_.contacts[point.contact];
        const Triple<double> y = numbers(point.place + at_point(point, u) - motion_[point.contact]);
        const Triple<double> before = numbers(point.place_before);
        const Triple<double> friction = numbers(point.friction_before);
        const auto traction = contact_traction(contact, y, before, friction, point.limit);
        // A (k <depth>^2 / 2 + what the elastic slip stores), with the limit held
        sum.energy += point.area * contact_energy(contact, y, before, friction, point.limit);
        const Vec3 on_body = values(traction.pressure) + values(traction.friction);
        for (std::size_t a = 0; a < point.face->size(); ++a)
            // f_a -= A N_a (p n + t) (method.md, 9.9)
            force.segment<3>(3 * (*point.face)[a]) -= point.area * point.value[a] * on_body;
    }
    sum.contact_force = force.norm();
    sum.force += force;
    sum.is_valid = std::isfinite(sum.energy) && force.allFinite();
    if (!sum.is_valid) sum.energy = std::numeric_limits<double>::infinity();
}

ContactAssembly::Slopes ContactAssembly::slopes_at(const Point& point,
                                                   const Eigen::VectorXd& u) const {
    const Vec3 y = point.place + at_point(point, u) - motion_[point.contact];
    const auto traction = contact_traction(model_.contacts[point.contact], variables(y, 0),
                                           variables(point.place_before, 3),
                                           variables(point.friction_before, 6), std::nullopt);
    Slopes slopes;
    // d(traction)/d(y, y_before, t0), limit = mu p(y) with its derivative
    slopes.friction = rates(traction.friction);
    slopes.traction = slopes.friction + rates(traction.pressure);
    slopes.by_coefficient.setZero();
    // t = z limit / |z|, limit = mu p: dt/dmu = t / mu where it slips, nothing where it sticks
    if (traction.is_slipping)
        for (int i = 0; i < 3; ++i)
            slopes.by_coefficient[i] =
                traction.friction[i].value() / model_.contacts[point.contact].friction;
    return slopes;
}

ContactAssembly::ShapeSlopes ContactAssembly::shape_slopes_at(const Point& point,
                                                              const Eigen::VectorXd& u) const {
    const Contact& contact = model_.contacts[point.contact];
    const Vec3 y = point.place + at_point(point, u) - motion_[point.contact];
    const auto traction = contact_traction(
        contact, size_variables(contact.obstacle), penalty_variables(contact), constants(y),
        constants(point.place_before), constants(point.friction_before), std::nullopt);
    ShapeSlopes slopes;
    for (int i = 0; i < 3; ++i) {
        slopes.friction.row(i) = traction.friction[i].derivatives().transpose();
        slopes.traction.row(i) =
            traction.pressure[i].derivatives().transpose() + slopes.friction.row(i);
    }
    return slopes;
}

void ContactAssembly::add_stiffness(const Point& point, const Mat3& stiffness,
                                    BlockMatrix& matrix) const {
    const Face& face = *point.face;
    for (std::size_t a = 0; a < face.size(); ++a)
        for (std::size_t b = 0; b < face.size(); ++b)
            // K_ab += A N_a N_b (-d traction / dy)
            add_block(matrix, face[a], face[b],
                      point.area * point.value[a] * point.value[b] * stiffness);
}

void ContactAssembly::add_tangent(const Eigen::VectorXd& u, BlockMatrix& matrix) const {
    for (const Point& point : points_) {
        const Vec3 y = point.place + at_point(point, u) - motion_[point.contact];
        const auto traction = contact_traction(model_.contacts[point.contact], variables(y, 0),
                                               variables(point.place_before, 3),
                                               variables(point.friction_before, 6), point.limit);
        // With the limit held p n + t is the gradient of an energy, so that this is symmetric.
        const Rates all = rates(traction.pressure) + rates(traction.friction);
        if (!all.isZero(0)) add_stiffness(point, -all.leftCols<3>(), matrix);
    }
}

void ContactAssembly::add_limit_rates(const Eigen::VectorXd& u, bool is_transposed,
                                      BlockMatrix& matrix) const {
    if (!has_friction()) return;
    for (const Point& point : points_) {
        const Vec3 y = point.place + at_point(point, u) - motion_[point.contact];
        const auto held = contact_traction(model_.contacts[point.contact], variables(y, 0),
                                           variables(point.place_before, 3),
                                           variables(point.friction_before, 6), point.limit);
        // dt/dlimit dlimit/dy, what the tangent with held limits lacks; only this is not symmetric.
        const Mat3 missing =
            slopes_at(point, u).friction.leftCols<3>() - rates(held.friction).leftCols<3>();
        const Mat3 turned = is_transposed ? Mat3(missing.transpose()) : missing;
        if (!missing.isZero(0)) add_stiffness(point, -turned, matrix);
    }
}

Eigen::VectorXd ContactAssembly::largest_stiffness() const {
    Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(model_.mesh.num_nodes());
    for (const Point& point : points_) {
        const Contact& contact = model_.contacts[point.contact];
        // Gershgorin: sum_b A N_a N_b max(k, k_t) bounds the contact's part of row a.
        double most = contact.stiffness_kpa_per_mm;
        if (contact.friction > 0) most = std::max(most, contact.slip_stiffness_kpa_per_mm);
        double sum = 0;
        for (std::size_t a = 0; a < point.face->size(); ++a) sum += std::abs(point.value[a]);
        for (std::size_t a = 0; a < point.face->size(); ++a)
            stiffness[(*point.face)[a]] += point.area * most * std::abs(point.value[a]) * sum;
    }
    return stiffness;
}

ContactState ContactAssembly::state(const Eigen::VectorXd& u) const {
    ContactState state;
    state.force.assign(model_.contacts.size(), Vec3::Zero());
    state.depth_mm.assign(model_.contacts.size(), 0.0);
    for (const Point& point : points_) {
        const Contact& contact = model_.contacts[point.contact];
        const Triple<double> y = numbers(point.place + at_point(point, u) - motion_[point.contact]);
        const auto traction = contact_traction(contact, y, numbers(point.place_before),
                                               numbers(point.friction_before), std::nullopt);
        // F = sum A (p n + t), of each obstacle on the body
        state.friction.push_back(values(traction.friction));
        state.force[point.contact] +=
            point.area * (values(traction.pressure) + values(traction.friction));
        state.depth_mm[point.contact] =
            std::max(state.depth_mm[point.contact], depth_in(contact.obstacle, y).depth);
    }
    return state;
}

Eigen::VectorXd ContactAssembly::friction_gradient(const Eigen::VectorXd& u,
                                                   const std::vector<Vec3>& slope) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(u.size());
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const Point& point = points_[k];
        if (slope[k].isZero(0)) continue;
        // (dt/dy)^T dJ/dt, then u_a gets N_a of it
        const Vec3 by_place = slopes_at(point, u).friction.leftCols<3>().transpose() * slope[k];
        for (std::size_t a = 0; a < point.face->size(); ++a)
            gradient.segment<3>(3 * (*point.face)[a]) += point.value[a] * by_place;
    }
    return gradient;
}

/// Of y, but for the displacement now, of y_before and of the friction then.
Eigen::Matrix<double, 9, 1> ContactAssembly::start_change(std::size_t point,
                                                          const ContactChange& change) const {
    const std::size_t contact = points_[point].contact;
    Eigen::Matrix<double, 9, 1> by = Eigen::Matrix<double, 9, 1>::Zero();
    // y = X + u - motion and y_before alike
    if (!change.motion.empty()) by.head<3>() -= change.motion[contact];
    if (!change.motion_before.empty()) by.segment<3>(3) -= change.motion_before[contact];
    if (change.displacement_before.size() > 0)
        by.segment<3>(3) += at_point(points_[point], change.displacement_before);
    if (!change.friction_before.empty()) by.tail<3>() = change.friction_before[point];
    return by;
}

/// Of the sizes and penalties of the point's obstacle.
Eigen::Matrix<double, 6, 1> ContactAssembly::shape_change(const Point& point,
                                                          const ContactChange& change) {
    Eigen::Matrix<double, 6, 1> by = Eigen::Matrix<double, 6, 1>::Zero();
    if (!change.sizes.empty()) by.head<4>() = change.sizes[point.contact];
    if (!change.penalties.empty()) by.tail<2>() = change.penalties[point.contact];
    return by;
}

Eigen::MatrixXd ContactAssembly::force_changes(const Eigen::VectorXd& u,
                                               const std::vector<ContactChange>& changes) const {
    Eigen::MatrixXd sum =
        Eigen::MatrixXd::Zero(u.size(), static_cast<Eigen::Index>(changes.size()));
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const Point& point = points_[k];
        const Slopes slopes = slopes_at(point, u);
        std::optional<ShapeSlopes> by_shape;  // of the point, whichever the change
        for (std::size_t c = 0; c < changes.size(); ++c) {
            Vec3 traction = slopes.traction * start_change(k, changes[c]);
            if (!changes[c].coefficient.empty())
                traction += changes[c].coefficient[point.contact] * slopes.by_coefficient;
            const Eigen::Matrix<double, 6, 1> shape = shape_change(point, changes[c]);
            if (!shape.isZero(0)) {
                if (!by_shape) by_shape = shape_slopes_at(point, u);
                traction += by_shape->traction * shape;
            }
            for (std::size_t a = 0; a < point.face->size(); ++a)
                // df_a = -A N_a d(p n + t)
                sum.col(static_cast<Eigen::Index>(c)).segment<3>(3 * (*point.face)[a]) -=
                    point.area * point.value[a] * traction;
        }
    }
    return sum;
}

std::vector<ContactStateChange> ContactAssembly::state_changes(
    const Eigen::VectorXd& u, const Eigen::MatrixXd& du,
    const std::vector<ContactChange>& changes) const {
    std::vector<ContactStateChange> result(changes.size());
    for (ContactStateChange& change : result)
        change.force.assign(model_.contacts.size(), Vec3::Zero());
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const Point& point = points_[k];
        const Slopes slopes = slopes_at(point, u);
        std::optional<ShapeSlopes> by_shape;
        for (std::size_t c = 0; c < changes.size(); ++c) {
            Eigen::Matrix<double, 9, 1> by = start_change(k, changes[c]);
            by.head<3>() += at_point(point, du.col(static_cast<Eigen::Index>(c)));
            Vec3 more = Vec3::Zero();  // of friction
            Vec3 pressure = Vec3::Zero();
            if (!changes[c].coefficient.empty())
                more = changes[c].coefficient[point.contact] * slopes.by_coefficient;
            const Eigen::Matrix<double, 6, 1> shape = shape_change(point, changes[c]);
            if (!shape.isZero(0)) {
                if (!by_shape) by_shape = shape_slopes_at(point, u);
                more += by_shape->friction * shape;
                pressure = (by_shape->traction - by_shape->friction) * shape;
            }
            // dF = sum A d(p n + t), and dt for the next step
            result[c].force[point.contact] += point.area * (slopes.traction * by + more + pressure);
            result[c].friction.push_back(slopes.friction * by + more);
        }
    }
    return result;
}

ContactGradient ContactAssembly::start_gradient(const Eigen::VectorXd& u,
                                                const Eigen::VectorXd& lambda,
                                                const std::vector<Vec3>& slope) const {
    ContactGradient sum;
    sum.displacement_before = Eigen::VectorXd::Zero(u.size());
    sum.motion.assign(model_.contacts.size(), Vec3::Zero());
    sum.motion_before = sum.motion;
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const Point& point = points_[k];
        const Slopes slopes = slopes_at(point, u);
        const Eigen::Matrix<double, 9, 1> total =
            // f_a has -A N_a (p n + t), so that -lambda . df = A lambda(x) . d(p n + t) (method.md,
            // 9.14);
            // friction is handed on to the next step besides.
            slopes.traction.transpose() * (point.area * at_point(point, lambda)) +
            slopes.friction.transpose() * slope[k];
        // y = X + u - motion and y_before alike: the motion's slopes have the other sign.
        sum.motion[point.contact] -= total.head<3>();
        sum.motion_before[point.contact] -= total.segment<3>(3);
        sum.friction_before.push_back(total.tail<3>());
        for (std::size_t a = 0; a < point.face->size(); ++a)
            sum.displacement_before.segment<3>(3 * (*point.face)[a]) +=
                point.value[a] * total.segment<3>(3);
    }
    return sum;
}

std::vector<Eigen::MatrixXd> ContactAssembly::shape_forces(const Eigen::VectorXd& u) const {
    std::vector<Eigen::MatrixXd> forces(model_.contacts.size(), Eigen::MatrixXd::Zero(u.size(), 4));
    for (const Point& point : points_) {
        const Eigen::Matrix<double, 3, 4> by_size =
            shape_slopes_at(point, u).traction.leftCols<4>();
        for (std::size_t a = 0; a < point.face->size(); ++a)
            // df_a/ds = -A N_a d(p n + t)/ds (method.md, 9.9)
            forces[point.contact].middleRows<3>(3 * (*point.face)[a]) -=
                point.area * point.value[a] * by_size;
    }
    return forces;
}

}  // namespace palpate
