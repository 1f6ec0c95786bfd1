// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "solver/equilibrium/newton.hpp"
#include "solver/materials/linear.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/surface_load.hpp"
#include "tests/fixtures/meshes.hpp"

// NAFEMS LE10: a quarter of a thick elliptic plate under pressure. Lengths are in m and stresses in
// MPa here; only their ratios enter.
namespace palpate {
namespace {

constexpr double half_thickness = 0.3, stiffness = 210e3, ratio = 0.3, pressure = 1;
constexpr double published_stress = -5.38;  ///< yy at D = (2, 0, 0.3)

/// From radial, angular and thickness coordinates in [0, 1].
Vec3 place_of(const Vec3& at) {
    const double angle = 0.5 * std::numbers::pi * at.y();
    const Vec3 inner(2 * std::cos(angle), std::sin(angle), 0);
    const Vec3 outer(3.25 * std::cos(angle), 2.75 * std::sin(angle), 0);
    return inner + at.x() * (outer - inner) + Vec3(0, 0, half_thickness * (2 * at.z() - 1));
}

struct Plate {
    SolidModel model;
    Eigen::VectorXd force;
    Index corner = 0;  ///< D
};

Plate make_plate(const std::array<Index, 3>& cells) {
    Plate plate;
    SolidMesh& mesh = plate.model.mesh;
    mesh = with_edge_nodes(solid_mesh_of(fixtures::box_mesh(cells, Vec3(1, 1, 1))));
    const std::vector<Vec3> at = mesh.nodes;
    for (Vec3& node : mesh.nodes) node = place_of(node);
    plate.model.materials = {{"linear", {stiffness, ratio}}};
    plate.model.prescribed.assign(3 * mesh.nodes.size(), 0);
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        std::uint8_t* held = &plate.model.prescribed[3 * n];
        if (at[n].y() < 1e-9) held[1] = 1;
        if (at[n].y() > 1 - 1e-9) held[0] = 1;
        if (at[n].x() > 1 - 1e-9) held[0] = held[1] = 1;
        if (at[n].x() > 1 - 1e-9 && std::abs(at[n].z() - 0.5) < 1e-9) held[2] = 1;
        if ((mesh.nodes[n] - Vec3(2, 0, half_thickness)).norm() < 1e-9) plate.corner = n;
    }
    const auto top = boundary_faces(mesh, [&](Index n) { return at[n].z() > 1 - 1e-9; });
    plate.force =
        traction_forces(mesh, top, [](const Vec3&, const Vec3& n) { return Vec3(-pressure * n); });
    return plate;
}

/// The stress yy of one element at one of its own nodes.
double stress_at(const SolidMesh& mesh, Index element, int node, const Eigen::VectorXd& u) {
    const auto nodes = mesh.nodes_of(element);
    const ShapeFunctions at = shape_functions(mesh.type, &mesh.table().reference[3 * node]);
    Mat3 mapping = Mat3::Zero(), slope = Mat3::Zero();
    for (std::size_t a = 0; a < nodes.size(); ++a) {
        const Eigen::Map<const Eigen::RowVector3d> gradient(at.gradient[a]);
        mapping += mesh.nodes[nodes[a]] * gradient;
        slope += u.segment<3>(3 * nodes[a]) * gradient;
    }
    const Mat3 h = slope * mapping.inverse();
    const LinearElastic law{stiffness, ratio};
    return stiffness * (law.unit_lambda() * h.trace() + 2 * law.unit_mu() * h(1, 1));
}

TEST(ThickPlate, HasThePublishedStressAtTheInnerEdge) {
    const Plate plate = make_plate({12, 16, 4});
    const SolidMesh& mesh = plate.model.mesh;
    const Equilibrium found =
        solve_equilibrium(SolidAssembly(plate.model),
                          {Eigen::VectorXd::Zero(plate.model.num_dofs()), plate.force}, {});
    ASSERT_TRUE(found.converged) << found.message;

    double sum = 0;
    int count = 0;
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (int a = 0; a < mesh.table().num_corners; ++a) {
            if (mesh.nodes_of(e)[a] != plate.corner) continue;
            sum += stress_at(mesh, e, a, found.displacement);
            ++count;
        }
    ASSERT_GT(count, 0);
    RecordProperty("stress", std::to_string(sum / count));
    EXPECT_NEAR(sum / count, published_stress, 0.02 * std::abs(published_stress));
}

}  // namespace
}  // namespace palpate
