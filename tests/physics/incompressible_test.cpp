// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "solver/equilibrium/newton.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/surface_load.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

constexpr double almost_half = 0.4999;

SolidModel held_nowhere(SolidMesh mesh, SolidMaterial material, VolumeTreatment volume) {
    SolidModel model{std::move(mesh), {std::move(material)}, {}, volume};
    model.prescribed.assign(3 * model.mesh.nodes.size(), 0);
    hold_in_plane(model);
    return model;
}

Eigen::VectorXd displacement_under(const SolidModel& model, const Eigen::VectorXd& force) {
    const Equilibrium found = solve_equilibrium(
        SolidAssembly(model), {Eigen::VectorXd::Zero(model.num_dofs()), force}, {});
    EXPECT_TRUE(found.converged) << found.message;
    return found.displacement;
}

/// Cook's tapered panel, 48 mm wide, 44 mm high at the clamped left and 16 mm at the right.
SolidMesh cooks_panel(ElementType type, Index cells) {
    SolidMesh mesh =
        fixtures::rectangle_mesh(type, Formulation::plane_strain, {cells, cells}, {1.0, 1.0});
    for (Vec3& x : mesh.nodes) {
        const double left = 44 * x.y(), right = 44 + 16 * x.y();
        x = Vec3(48 * x.x(), left + (right - left) * x.x(), 0);
    }
    return mesh;
}

/// How far the upper right corner rises under a shear of 1 / 16 kPa on the right edge, E = 1 kPa,
/// per mm of thickness, mm.
double cooks_tip(SolidMesh mesh, VolumeTreatment volume, double poisson_ratio) {
    SolidModel model = held_nowhere(std::move(mesh), {"linear", {1.0, poisson_ratio}}, volume);
    Index tip = 0;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        if (x.x() < 1e-9) std::fill_n(&model.prescribed[3 * n], 3, 1);
        if ((x - Vec3(48, 60, 0)).norm() < 1e-9) tip = n;
    }
    const auto edge =
        boundary_faces(model.mesh, [&](Index n) { return model.mesh.nodes[n].x() > 48 - 1e-9; });
    const Eigen::VectorXd force = traction_forces(
        model.mesh, edge, [](const Vec3&, const Vec3&) { return Vec3(0, 1.0 / 16, 0); });
    return displacement_under(model, force)[3 * tip + 1];
}

// The tip by very fine quadratic triangles with a mean volume, to which both elements converge.
TEST(Incompressible, CooksMembraneDoesNotLock) {
    const auto quadratic = [](Index cells) {
        return with_edge_nodes(cooks_panel(ElementType::tri3, cells));
    };
    const double reference = cooks_tip(quadratic(48), VolumeTreatment::element_mean, almost_half);
    const double tri6 = cooks_tip(quadratic(12), VolumeTreatment::element_mean, almost_half);
    const double quad4 =
        cooks_tip(cooks_panel(ElementType::quad4, 24), VolumeTreatment::element_mean, almost_half);
    const double locked =
        cooks_tip(cooks_panel(ElementType::quad4, 24), VolumeTreatment::pointwise, almost_half);
    RecordProperty("reference", std::to_string(reference));
    EXPECT_NEAR(tri6, reference, 0.02 * reference);
    EXPECT_NEAR(quad4, reference, 0.02 * reference);
    EXPECT_LT(locked, 0.8 * reference);
}

/// An octant of a sphere shell, inner radius 10 mm, outer 20 mm, edge nodes moved onto spheres.
SolidMesh quadratic_shell(Index subdivisions, Index layers) {
    SolidMesh mesh =
        with_edge_nodes(solid_mesh_of(fixtures::octant_shell_mesh(subdivisions, layers, 10, 20)));
    const ElementTable& table = mesh.table();
    static constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (int k = 0; k < 6; ++k) {
            const auto nodes = mesh.nodes_of(e);
            const double radius = 0.5 * (mesh.nodes[nodes[edges[k][0]]].norm() +
                                         mesh.nodes[nodes[edges[k][1]]].norm());
            Vec3& middle = mesh.nodes[nodes[table.num_corners + k]];
            middle = radius * middle.normalized();
        }
    return mesh;
}

/// Radial displacement of a thick sphere under an inner pressure, Lame, mm.
double lames_displacement(double stiffness, double ratio, double pressure, double radius) {
    constexpr double a = 10, b = 20;
    return pressure * a * a * a / (stiffness * (b * b * b - a * a * a)) *
           ((1 - 2 * ratio) * radius + (1 + ratio) * b * b * b / (2 * radius * radius));
}

TEST(Incompressible, AThickSphereUnderPressureDoesNotLock) {
    constexpr double stiffness = 10, pressure = 0.5;
    SolidModel model = held_nowhere(quadratic_shell(5, 4), {"linear", {stiffness, almost_half}},
                                    VolumeTreatment::element_mean);
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        for (int c = 0; c < 3; ++c)
            if (std::abs(model.mesh.nodes[n][c]) < 1e-9) model.prescribed[3 * n + c] = 1;
    const auto inside =
        boundary_faces(model.mesh, [&](Index n) { return model.mesh.nodes[n].norm() < 10 + 1e-6; });
    const Eigen::VectorXd force = traction_forces(
        model.mesh, inside, [&](const Vec3&, const Vec3& n) { return Vec3(-pressure * n); });

    const Eigen::VectorXd u = displacement_under(model, force);

    double worst = 0;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        const double expected = lames_displacement(stiffness, almost_half, pressure, x.norm());
        worst = std::max(worst, std::abs(u.segment<3>(3 * n).dot(x.normalized()) / expected - 1));
    }
    RecordProperty("worst_relative_error", std::to_string(worst));
    EXPECT_LT(worst, 0.02);
}

}  // namespace
}  // namespace palpate
