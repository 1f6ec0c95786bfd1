// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solver/equilibrium/newton.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

constexpr double inner_mm = 10, outer_mm = 20, shear_kpa = 5, bulk_kpa = 2e4;

/// A thick incompressible neo-Hookean sphere, W = shear / 2 (I1 - 3), inflated by p (Ogden 1984,
/// section 5.3.2): with the stretch l = r / R round the centre,
///   p = int_(l_b)^(l_a) W'(l) / (l^3 - 1) dl,   W(l) = shear / 2 (l^-4 + 2 l^2 - 3),
///     = shear int (l^-2 + l^-5) 2 dl = shear [-2 / l - 1 / (2 l^4)] from l_b to l_a,
/// l_a, l_b at the inner and outer surface: B^3 (l_b^3 - 1) = A^3 (l_a^3 - 1).
double pressure_at(double inner_stretch) {
    const double outer_stretch =
        std::cbrt(1 + std::pow(inner_mm / outer_mm, 3) * (std::pow(inner_stretch, 3) - 1));
    const auto sum = [](double l) { return -2 / l - 0.5 / std::pow(l, 4); };
    return shear_kpa * (sum(inner_stretch) - sum(outer_stretch));
}

/// A quarter of the section through the axis.
SolidMesh section_mesh(Index layers) {
    SolidMesh mesh = fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric,
                                              {layers, 2 * layers}, {1.0, 1.0});
    for (Vec3& node : mesh.nodes) {
        const double radius = inner_mm + (outer_mm - inner_mm) * node.x();
        const double angle = 0.5 * std::numbers::pi * node.y();
        node = Vec3(radius * std::cos(angle), radius * std::sin(angle), 0);
        if (node.x() < 1e-9) node.x() = 0;
        if (node.y() < 1e-9) node.y() = 0;
    }
    return mesh;
}

SolidMesh octant_mesh(Index subdivisions, Index layers) {
    SolidMesh mesh = with_edge_nodes(
        solid_mesh_of(fixtures::octant_shell_mesh(subdivisions, layers, inner_mm, outer_mm)));
    // Middle nodes of both surfaces go onto the spheres.
    for (const Face& face : boundary_faces(mesh))
        for (const double radius : {inner_mm, outer_mm}) {
            const auto is_on = [&](std::size_t a) {
                return std::abs(mesh.nodes[face[a]].norm() - radius) < 1e-9;
            };
            if (is_on(0) && is_on(1) && is_on(2))
                for (const Index node : face) mesh.nodes[node] *= radius / mesh.nodes[node].norm();
        }
    return mesh;
}

double inflated_stretch(const SolidMesh& mesh, double kpa, bool follows = true) {
    SolidModel model =
        fixtures::solid_model(mesh, {"neo-hookean-reduced", {shear_kpa / 2, bulk_kpa}});
    model.volume = VolumeTreatment::element_mean;
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        for (int c = 0; c < 3; ++c)
            if (mesh.nodes[n][c] == 0) model.prescribed[3 * n + c] = 1;
    const auto faces = boundary_faces(
        mesh, [&](Index n) { return std::abs(mesh.nodes[n].norm() - inner_mm) < 1e-6; });
    SolidLoads loads;
    loads.displacement.setZero(model.num_dofs());
    loads.force.setZero(model.num_dofs());
    if (follows) {
        model.pressures = {{faces}};
        loads.pressure_kpa = {kpa};
    } else {
        loads.force = traction_forces(mesh, faces,
                                      [&](const Vec3&, const Vec3& n) -> Vec3 { return -kpa * n; });
    }
    const Equilibrium found = solve_equilibrium(SolidAssembly(model), loads, {});
    EXPECT_TRUE(found.converged) << found.message;
    double sum = 0, count = 0;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        if (std::abs(mesh.nodes[n].norm() - inner_mm) > 1e-6) continue;
        sum += (mesh.nodes[n] + found.displacement.segment<3>(3 * n)).norm() / inner_mm;
        count += 1;
    }
    return sum / count;
}

TEST(InflatedSphere, FollowsTheClosedFormAtHalfAsLargeAgain) {
    double before = 0;
    for (const Index layers : {8, 16}) {
        const double error =
            std::abs(inflated_stretch(section_mesh(layers), pressure_at(1.5)) - 1.5);
        EXPECT_LT(error, 8e-3);
        if (before > 0) {
            EXPECT_LT(error, 0.35 * before);
        }
        before = error;
    }
    EXPECT_LT(before, 2e-3);
}

TEST(InflatedSphere, InSpaceFollowsTheClosedForm) {
    EXPECT_NEAR(inflated_stretch(octant_mesh(4, 4), pressure_at(1.4)), 1.4, 5e-3);
}

// The pressure of constant area and direction is another load: it misses half of the inflation.
TEST(InflatedSphere, WithoutFollowingItIsSmaller) {
    EXPECT_LT(inflated_stretch(section_mesh(8), pressure_at(1.5), false), 1.3);
}

}  // namespace
}  // namespace palpate
