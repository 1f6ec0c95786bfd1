// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solver/base/error.hpp"
#include "solver/equilibrium/contact_assembly.hpp"
#include "solver/equilibrium/contact_traction.hpp"
#include "solver/model/block_product.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

Obstacle obstacle_of(ObstacleShape shape) {
    Obstacle obstacle;
    obstacle.shape = shape;
    obstacle.place = Vec3(1, -2, 0.5);
    obstacle.direction = Vec3(1, 2, 2);
    obstacle.radius_mm = 3;
    return obstacle;
}

double depth_of(const Obstacle& obstacle, const Vec3& at) {
    return depth_in<double>(obstacle, {at[0], at[1], at[2]}).depth;
}

TEST(Obstacle, DepthIsTheDistanceToItsSurface) {
    const Vec3 along = Vec3(1, 2, 2) / 3, across = Vec3(2, 1, -2) / 3, place(1, -2, 0.5);
    const Obstacle plane = obstacle_of(ObstacleShape::plane);
    EXPECT_NEAR(depth_of(plane, place + 0.5 * along + 4 * across), -0.5, 1e-14);
    EXPECT_NEAR(depth_of(plane, place - 2 * along), 2, 1e-14);
    Obstacle cylinder = obstacle_of(ObstacleShape::cylinder);
    EXPECT_NEAR(depth_of(cylinder, place + 7 * along + 2 * across), 1, 1e-14);
    cylinder.is_hollow = true;
    EXPECT_NEAR(depth_of(cylinder, place + 7 * along + 2 * across), -1, 1e-14);
    const Obstacle sphere = obstacle_of(ObstacleShape::sphere);
    EXPECT_NEAR(depth_of(sphere, place + 4 * along + 3 * across), -2, 1e-14);
}

TEST(Obstacle, NormalsPointOutAndAreTheSlopeOfTheDepth) {
    for (const auto shape : {ObstacleShape::plane, ObstacleShape::cylinder, ObstacleShape::sphere})
        for (const bool is_hollow : {false, true}) {
            Obstacle obstacle = obstacle_of(shape);
            obstacle.is_hollow = is_hollow;
            const Vec3 at(2.2, 0.3, 1.1);
            const auto found = depth_in<double>(obstacle, {at[0], at[1], at[2]});
            for (int i = 0; i < 3; ++i) {
                constexpr double step = 1e-6;
                const double slope = (depth_of(obstacle, at + step * Vec3::Unit(i)) -
                                      depth_of(obstacle, at - step * Vec3::Unit(i))) /
                                     (2 * step);
                EXPECT_NEAR(-found.normal[i], slope, 1e-8) << name_of(shape);
            }
        }
}

/// A box whose upper face is in a sphere, cylinder or plane, and slips.
struct Pressed {
    SolidModel model;
    ContactStart start;
    std::vector<Vec3> motion{Vec3(0.05, -0.02, -0.3)};
    Eigen::VectorXd u;
};

Pressed pressed_by(ObstacleShape shape, const SolidMesh& mesh) {
    Pressed pressed;
    pressed.model = fixtures::solid_model(mesh, {"neo-hookean", {10, 0.35}});
    const bool is_solid = mesh.formulation == Formulation::solid;
    const int up = is_solid ? 2 : 1;
    Contact contact;
    contact.obstacle.shape = shape;
    const bool is_flat = shape == ObstacleShape::plane || has_edge(shape);
    contact.obstacle.direction = is_flat    ? Vec3(-Vec3::Unit(up))
                                 : is_solid ? Vec3(Vec3::UnitY())
                                            : Vec3(Vec3::UnitZ());
    contact.obstacle.radius_mm = shape == ObstacleShape::tube ? 0.4 : is_flat ? 1.3 : 4;
    contact.obstacle.edge_radius_mm = 0.5;
    contact.obstacle.outer_radius_mm = 1.9;
    contact.obstacle.outer_edge_radius_mm = 0.6;
    const bool is_turned = has_edge(shape) && mesh.formulation == Formulation::axisymmetric;
    contact.obstacle.place = Vec3(is_turned ? 0 : 1, 0.7, 0);
    contact.obstacle.place[up] = is_flat ? 2.05 : 6.05;
    contact.stiffness_kpa_per_mm = 50;
    contact.slip_stiffness_kpa_per_mm = 30;
    contact.friction = 0.4;
    contact.faces = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n][up] > 2 - 1e-9; });
    pressed.model.contacts = {contact};
    pressed.u.resize(pressed.model.num_dofs());
    for (Index d = 0; d < pressed.u.size(); ++d) pressed.u[d] = 0.03 * std::sin(1.3 * d);
    if (!is_solid)
        for (Index n = 0; n < mesh.num_nodes(); ++n) pressed.u[3 * n + 2] = 0;
    if (!is_solid) pressed.motion[0].z() = 0, pressed.motion[0].y() = -0.3;
    pressed.start.displacement = 0.4 * pressed.u;
    pressed.start.motion = {0.2 * pressed.motion[0]};
    const ContactAssembly points(pressed.model);
    pressed.start.friction = points.state(pressed.u).friction;
    for (std::size_t k = 0; k < pressed.start.friction.size(); ++k)
        pressed.start.friction[k] = Vec3(0.5, is_solid ? -0.2 : 0, 0) * std::cos(2.0 * k);
    return pressed;
}

template <class Work>
void for_each_pressed(Work&& work) {
    for (const SolidMesh& mesh : fixtures::solid_meshes())
        for (const auto shape :
             {ObstacleShape::plane, ObstacleShape::cylinder, ObstacleShape::sphere,
              ObstacleShape::tube, ObstacleShape::punch}) {
            const std::string name = std::string(name_of(shape)) + ", " + mesh.table().name;
            work(pressed_by(shape, mesh), name);
        }
}

InternalForce force_at(const ContactAssembly& contact, const Eigen::VectorXd& u) {
    InternalForce sum;
    sum.force.setZero(u.size());
    contact.add_force(u, sum);
    return sum;
}

Eigen::VectorXd direction_of(const Eigen::VectorXd& u) {
    Eigen::VectorXd v(u.size());
    for (Index d = 0; d < v.size(); ++d) v[d] = std::cos(0.7 * d);
    return v;
}

TEST(Contact, ForcesAreTheSlopeOfTheEnergyWhileLimitsAreHeld) {
    for_each_pressed([](const Pressed& pressed, const std::string& name) {
        ContactAssembly contact(pressed.model);
        contact.begin(pressed.start);
        contact.place(pressed.motion);
        contact.renew_limits(pressed.u);
        const Eigen::VectorXd v = direction_of(pressed.u);
        constexpr double step = 1e-6;
        const double slope = (force_at(contact, pressed.u + step * v).energy -
                              force_at(contact, pressed.u - step * v).energy) /
                             (2 * step);
        const double expected = force_at(contact, pressed.u).force.dot(v);
        EXPECT_GT(force_at(contact, pressed.u).contact_force, 1) << name;
        EXPECT_NEAR(slope, expected, 1e-6 * std::abs(expected)) << name;
    });
}

TEST(Contact, StiffnessIsTheSlopeOfTheForce) {
    for_each_pressed([](const Pressed& pressed, const std::string& name) {
        ContactAssembly contact(pressed.model);
        contact.begin(pressed.start);
        contact.place(pressed.motion);
        contact.renew_limits(pressed.u);
        const SolidAssembly solid(pressed.model);
        BlockMatrix held = solid.make_matrix(), rates = held, transposed = held;
        contact.add_tangent(pressed.u, held);
        contact.add_limit_rates(pressed.u, false, rates);
        contact.add_limit_rates(pressed.u, true, transposed);
        const Eigen::VectorXd v = direction_of(pressed.u);
        constexpr double step = 1e-6;
        const auto slope = [&](bool renews) {
            const auto force = [&](double by) {
                const Eigen::VectorXd at = pressed.u + by * v;
                if (renews) contact.renew_limits(at);
                return force_at(contact, at).force;
            };
            const Eigen::VectorXd result = (force(step) - force(-step)) / (2 * step);
            contact.renew_limits(pressed.u);
            return result;
        };
        const Eigen::VectorXd expected = slope(false), all = slope(true);
        EXPECT_LT((times(held, v) - expected).norm(), 1e-6 * expected.norm()) << name;
        EXPECT_LT((times(rates, v) - (all - expected)).norm(), 1e-5 * all.norm()) << name;
        const Eigen::VectorXd w = direction_of(0.5 * pressed.u).reverse();
        EXPECT_NEAR(v.dot(times(transposed, w).col(0)), w.dot(times(rates, v).col(0)),
                    1e-9 * all.norm())
            << name;
    });
}

TEST(Contact, FrictionNeverExceedsItsLimitAndRunsAcrossTheNormal) {
    for_each_pressed([](const Pressed& pressed, const std::string& name) {
        ContactAssembly contact(pressed.model);
        contact.begin(pressed.start);
        contact.place(pressed.motion);
        const ContactState state = contact.state(pressed.u);
        int slipping = 0;
        for (const Vec3& friction : state.friction) slipping += friction.norm() > 1e-3;
        EXPECT_GT(slipping, 0) << name;
        const Contact& law = pressed.model.contacts[0];
        for (const Vec3& friction : state.friction)
            EXPECT_LE(friction.norm(),
                      law.friction * law.stiffness_kpa_per_mm * state.depth_mm[0] * (1 + 1e-12))
                << name;
    });
}

double& size_of(Obstacle& obstacle, int k) {
    double* list[] = {&obstacle.radius_mm, &obstacle.edge_radius_mm, &obstacle.outer_radius_mm,
                      &obstacle.outer_edge_radius_mm};
    return *list[k];
}

TEST(Contact, ForcesChangeWithTheSizesOfObstacles) {
    for_each_pressed([](const Pressed& pressed, const std::string& name) {
        const auto force_with = [&](int k, double by) {
            SolidModel model = pressed.model;
            size_of(model.contacts[0].obstacle, k) += by;
            ContactAssembly contact(model);
            contact.begin(pressed.start);
            contact.place(pressed.motion);
            contact.renew_limits(pressed.u);
            return force_at(contact, pressed.u).force;
        };
        ContactAssembly contact(pressed.model);
        contact.begin(pressed.start);
        contact.place(pressed.motion);
        const Eigen::MatrixXd found = contact.shape_forces(pressed.u)[0];
        constexpr double step = 1e-6;
        for (int k = 0; k < 4; ++k) {
            const Eigen::VectorXd expected =
                (force_with(k, step) - force_with(k, -step)) / (2 * step);
            EXPECT_LT((found.col(k) - expected).norm(), 1e-6 * expected.norm() + 1e-7)
                << name << ", " << obstacle_sizes[k];
        }
        if (has_edge(pressed.model.contacts[0].obstacle.shape)) {
            EXPECT_GT(found.col(1).norm(), 1e-2) << name;
        }
    });
}

TEST(Contact, WhatIsNoObstacleIsRefused) {
    const SolidMesh box = fixtures::solid_meshes()[0];
    const auto refuses = [&](auto&& spoil) {
        SolidModel model = fixtures::solid_model(box, {"neo-hookean", {10, 0.35}});
        Contact contact;
        contact.stiffness_kpa_per_mm = 1;
        spoil(contact);
        model.contacts = {contact};
        EXPECT_THROW(check_model(model), Error);
    };
    refuses([](Contact& c) { c.stiffness_kpa_per_mm = 0; });
    refuses([](Contact& c) { c.friction = -0.1; });
    refuses([](Contact& c) { c.friction = 0.1; });
    refuses([](Contact& c) { c.obstacle.direction.setZero(); });
    refuses([](Contact& c) { c.obstacle.place.x() = std::nan(""); });
    refuses([](Contact& c) { c.faces = {{0, 1, 1000}}; });
    refuses([](Contact& c) {
        c.obstacle.shape = ObstacleShape::sphere;
        c.obstacle.radius_mm = -1;
    });
    const auto refuses_edge = [&](ObstacleShape shape, auto&& spoil) {
        refuses([&](Contact& c) {
            c.obstacle.shape = shape;
            c.obstacle.edge_radius_mm = c.obstacle.outer_edge_radius_mm = 0.2;
            c.obstacle.outer_radius_mm = 2;
            spoil(c.obstacle);
        });
    };
    refuses_edge(ObstacleShape::tube, [](Obstacle& o) { o.edge_radius_mm = 0; });
    refuses_edge(ObstacleShape::tube, [](Obstacle& o) { o.outer_radius_mm = 1.3; });
    refuses_edge(ObstacleShape::tube, [](Obstacle& o) { o.outer_edge_radius_mm = 1; });
    refuses_edge(ObstacleShape::tube, [](Obstacle& o) { o.radius_mm = -1; });
    refuses_edge(ObstacleShape::punch, [](Obstacle& o) { o.edge_radius_mm = 1.1; });
    refuses_edge(ObstacleShape::punch, [](Obstacle& o) { o.edge_radius_mm = std::nan(""); });
    EXPECT_THROW(obstacle_shape_of("cone"), Error);
    EXPECT_EQ(obstacle_shape_of("sphere"), ObstacleShape::sphere);
}

}  // namespace
}  // namespace palpate
