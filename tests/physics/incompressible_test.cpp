// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "solver/elements/tet10.hpp"
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

/// How far the panel rises at `where` under a shear of `load_kpa` on the right edge, E = 1 kPa,
/// over the rise that 1 / 16 kPa would give in proportion, mm.
double cooks_rise(SolidMesh mesh, SolidMaterial material, VolumeTreatment volume, const Vec3& where,
                  double load_kpa = 1.0 / 16) {
    SolidModel model = held_nowhere(std::move(mesh), std::move(material), volume);
    Index tip = -1;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        if (x.x() < 1e-9) std::fill_n(&model.prescribed[3 * n], 3, 1);
        if ((x - where).norm() < 1e-9) tip = n;
    }
    const auto edge =
        boundary_faces(model.mesh, [&](Index n) { return model.mesh.nodes[n].x() > 48 - 1e-9; });
    const Eigen::VectorXd force = traction_forces(
        model.mesh, edge, [&](const Vec3&, const Vec3&) { return Vec3(0, load_kpa, 0); });
    return displacement_under(model, force)[3 * tip + 1] / (16 * load_kpa);
}

const Vec3 corner(48, 60, 0), middle_of_the_end(48, 52, 0);

// Plane stress, nu = 1/3, at the middle of the loaded end: 23.96 (Simo and Rifai 1990 and others).
TEST(CooksPanel, RisesAsPublishedInPlaneStress) {
    const SolidMaterial linear{"linear", {1.0, 1.0 / 3}};
    SolidMesh mesh = cooks_panel(ElementType::tri3, 12);
    mesh.formulation = Formulation::plane_stress;
    const double tri6 =
        cooks_rise(with_edge_nodes(mesh), linear, VolumeTreatment::pointwise, middle_of_the_end);
    EXPECT_NEAR(tri6, 23.96, 0.005 * 23.96);
}

// The corner by very fine quadratic triangles with a mean volume, to which all elements converge,
// and which quadratic triangles without one approach too.
TEST(Incompressible, CooksPanelDoesNotLock) {
    const auto mean = VolumeTreatment::element_mean;
    const auto quadratic = [](Index cells) {
        return with_edge_nodes(cooks_panel(ElementType::tri3, cells));
    };
    const SolidMaterial linear{"linear", {1.0, almost_half}};
    const double reference = cooks_rise(quadratic(40), linear, mean, corner);
    const double fine = cooks_rise(quadratic(40), linear, VolumeTreatment::pointwise, corner);
    EXPECT_NEAR(fine, reference, 0.02 * reference);
    const double tri6 = cooks_rise(quadratic(12), linear, mean, corner);
    EXPECT_NEAR(tri6, reference, 0.02 * reference);
    const SolidMesh quads = cooks_panel(ElementType::quad4, 24);
    const double quad4 = cooks_rise(quads, linear, mean, corner);
    EXPECT_NEAR(quad4, reference, 0.02 * reference);
    const double locked = cooks_rise(quads, linear, VolumeTreatment::pointwise, corner);
    EXPECT_LT(locked, 0.8 * reference);
    // A large deformation law under a small load.
    const double neo_hookean =
        cooks_rise(quads, {"neo-hookean", {1.0, almost_half}}, mean, corner, 1e-6);
    EXPECT_NEAR(neo_hookean, quad4, 1e-3 * quad4);
}

/// Radial displacement of a long thick tube under an inner pressure, held along its axis, mm.
double tubes_displacement(double stiffness, double ratio, double pressure, double radius) {
    constexpr double a = 10, b = 20;
    return (1 + ratio) * pressure * a * a / (stiffness * (b * b - a * a)) *
           ((1 - 2 * ratio) * radius + b * b / radius);
}

TEST(Incompressible, AThickTubeUnderPressureDoesNotLock) {
    constexpr double stiffness = 10, pressure = 1e-4;
    for (const char* law : {"linear", "neo-hookean"}) {
        SolidMesh mesh = fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric,
                                                  {8, 2}, {10.0, 2.0});
        for (Vec3& x : mesh.nodes) x.x() += 10;
        SolidModel model =
            held_nowhere(mesh, {law, {stiffness, almost_half}}, VolumeTreatment::element_mean);
        for (Index n = 0; n < mesh.num_nodes(); ++n) model.prescribed[3 * n + 1] = 1;
        const auto inside =
            boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].x() < 10 + 1e-9; });
        const Eigen::VectorXd force = traction_forces(
            mesh, inside, [&](const Vec3&, const Vec3& n) { return Vec3(-pressure * n); });

        const Eigen::VectorXd u = displacement_under(model, force);

        for (Index n = 0; n < mesh.num_nodes(); ++n) {
            const double expected =
                tubes_displacement(stiffness, almost_half, pressure, mesh.nodes[n].x());
            EXPECT_NEAR(u[3 * n], expected, 0.01 * expected) << law;
        }
    }
}

/// An octant of a sphere shell, inner radius 10 mm, outer 20 mm, edge nodes moved onto spheres.
SolidMesh quadratic_shell(Index subdivisions, Index layers) {
    SolidMesh mesh =
        with_edge_nodes(solid_mesh_of(fixtures::octant_shell_mesh(subdivisions, layers, 10, 20)));
    const ElementTable& table = mesh.table();
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (int k = 0; k < 6; ++k) {
            const auto nodes = mesh.nodes_of(e);
            const double radius = 0.5 * (mesh.nodes[nodes[tet10_edges[k][0]]].norm() +
                                         mesh.nodes[nodes[tet10_edges[k][1]]].norm());
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

constexpr double inner_pressure = 1e-4;

SolidModel sphere_model(const SolidMesh& mesh, const std::string& law, VolumeTreatment volume) {
    SolidModel model = held_nowhere(mesh, {law, {10, almost_half}}, volume);
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        for (int c = 0; c < 3; ++c)
            if (std::abs(mesh.nodes[n][c]) < 1e-9) model.prescribed[3 * n + c] = 1;
    return model;
}

Eigen::VectorXd blown_up(const SolidModel& model) {
    const auto inside =
        boundary_faces(model.mesh, [&](Index n) { return model.mesh.nodes[n].norm() < 10 + 1e-6; });
    return displacement_under(model,
                              traction_forces(model.mesh, inside, [&](const Vec3&, const Vec3& n) {
                                  return Vec3(-inner_pressure * n);
                              }));
}

/// The largest error of the radial displacement of a thick sphere under pressure, relative.
double spheres_error(const SolidMesh& mesh, const std::string& law, VolumeTreatment volume) {
    const Eigen::VectorXd u = blown_up(sphere_model(mesh, law, volume));
    double worst = 0;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const Vec3& x = mesh.nodes[n];
        const double expected = lames_displacement(10, almost_half, inner_pressure, x.norm());
        const double found = u.segment<3>(3 * n).dot(x.normalized());
        worst = std::max(worst, std::abs(found / expected - 1));
    }
    return worst;
}

TEST(Incompressible, AThickSphereUnderPressureDoesNotLock) {
    for (const char* law : {"linear", "neo-hookean"}) {
        const double worst =
            spheres_error(quadratic_shell(5, 4), law, VolumeTreatment::element_mean);
        RecordProperty(std::string("worst_relative_error_") + law, std::to_string(worst));
        EXPECT_LT(worst, 0.02) << law;
    }
}

/// tr P / 3 of every element at u: at small strains the mean stress.
std::vector<double> mean_stresses(const SolidModel& model, const Eigen::VectorXd& u) {
    const auto points = SolidAssembly(model).point_states(u);
    const auto count = static_cast<std::size_t>(model.mesh.table().num_points);
    std::vector<double> stresses;
    for (Index e = 0; e < model.mesh.num_elements(); ++e) {
        double sum = 0, volume = 0;
        for (std::size_t q = 0; q < count; ++q) {
            const PointState& point = points[e * count + q];
            sum += point.volume * trace(point.stress) / 3;
            volume += point.volume;
        }
        stresses.push_back(sum / volume);
    }
    return stresses;
}

// In a thick sphere the mean stress is p a^3 / (b^3 - a^3) everywhere: elements that take turns in
// being too high and too low would show.
TEST(Incompressible, PressureHasNoCheckerboardInAThickSphere) {
    constexpr double expected = inner_pressure / 7;
    const SolidModel mean =
        sphere_model(quadratic_shell(5, 4), "neo-hookean", VolumeTreatment::element_mean);
    double worst = 0, sum = 0;
    const auto stresses = mean_stresses(mean, blown_up(mean));
    for (const double stress : stresses) {
        worst = std::max(worst, std::abs(stress - expected));
        sum += stress / static_cast<double>(stresses.size());
    }
    RecordProperty("worst_of_inner_pressure", std::to_string(worst / inner_pressure));
    EXPECT_NEAR(sum, expected, 0.01 * inner_pressure);
    EXPECT_LT(worst, 0.15 * inner_pressure);
    // What a checkerboard looks like.
    const SolidModel locked =
        sphere_model(quadratic_shell(5, 4), "neo-hookean", VolumeTreatment::pointwise);
    double worst_locked = 0;
    for (const double stress : mean_stresses(locked, blown_up(locked)))
        worst_locked = std::max(worst_locked, std::abs(stress - expected));
    RecordProperty("worst_pointwise", std::to_string(worst_locked / inner_pressure));
}

/// The part of the mean stress in Cook's panel that takes turns from one quad4 to the next, of its
/// root mean square.
double cooks_checkerboard(Index cells) {
    const SolidMesh mesh = cooks_panel(ElementType::quad4, cells);
    SolidModel model =
        held_nowhere(mesh, {"linear", {1, almost_half}}, VolumeTreatment::element_mean);
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n].x() < 1e-9) std::fill_n(&model.prescribed[3 * n], 3, 1);
    const auto edge = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].x() > 48 - 1e-9; });
    const auto stresses = mean_stresses(
        model, displacement_under(model, traction_forces(mesh, edge, [](const Vec3&, const Vec3&) {
                                      return Vec3(0, 1e-4, 0);
                                  })));
    // The stencil below is 1 for a checkerboard and 0 for what is linear along either axis. The
    // clamped corners, where stress has no bound, are left out.
    double size = 0, rough = 0;
    for (Index j = 1; j + 1 < cells; ++j)
        for (Index i = cells / 4; i + 1 < cells; ++i) {
            double part = 0;
            for (Index dj = -1; dj <= 1; ++dj)
                for (Index di = -1; di <= 1; ++di)
                    part += (di == 0 ? 2 : -1) * (dj == 0 ? 2 : -1) / 16.0 *
                            stresses[i + di + cells * (j + dj)];
            size += std::pow(stresses[i + cells * j], 2);
            rough += part * part;
        }
    return std::sqrt(rough / size);
}

// A checkerboard would stay as the mesh is refined.
TEST(Incompressible, PressureHasNoCheckerboardInCooksPanel) {
    const double coarse = cooks_checkerboard(12), fine = cooks_checkerboard(24);
    RecordProperty("coarse", std::to_string(coarse));
    RecordProperty("fine", std::to_string(fine));
    EXPECT_LT(fine, 0.1);
    EXPECT_LT(fine, 0.7 * coarse);
}

// Why tetrahedra are quadratic with a mean volume: linear ones on the same nodes lock, and
// quadratic ones whose points all keep their volume are stiffer than with a mean.
TEST(Incompressible, LinearTetrahedraOnTheSameNodesLock) {
    const SolidMesh linear = solid_mesh_of(fixtures::octant_shell_mesh(10, 8, 10, 20));
    const double tet4 = spheres_error(linear, "linear", VolumeTreatment::pointwise);
    const double pointwise =
        spheres_error(quadratic_shell(5, 4), "linear", VolumeTreatment::pointwise);
    const double mean =
        spheres_error(quadratic_shell(5, 4), "linear", VolumeTreatment::element_mean);
    RecordProperty("tet4", std::to_string(tet4));
    RecordProperty("tet10_pointwise", std::to_string(pointwise));
    RecordProperty("tet10_mean", std::to_string(mean));
    EXPECT_GT(tet4, 0.3);
    EXPECT_LT(mean, 0.5 * pointwise);
}

}  // namespace
}  // namespace palpate
