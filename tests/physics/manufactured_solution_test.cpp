// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>

#include "solver/equilibrium/newton.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

constexpr double amplitude_mm = 0.03;
constexpr double pi = std::numbers::pi;

/// A displacement of a unit cube or square, all of it prescribed on the outside.
Vec3 exact(const Vec3& x, bool is_plane) {
    if (is_plane)
        return amplitude_mm * Vec3(std::sin(pi * x.x()) * std::cos(pi * x.y() / 2) + x.y() * x.y(),
                                   std::cos(pi * x.x() / 2) * std::sin(pi * x.y()), 0);
    return amplitude_mm * Vec3(std::sin(pi * x.x()) * std::cos(pi * x.y() / 2) + x.z() * x.z(),
                               std::cos(pi * x.x() / 2) * std::sin(pi * x.z()),
                               std::sin(pi * x.y()) * x.x() + std::sin(pi * x.z() / 2));
}

Tensor3<double> exact_gradient(const Vec3& x, bool is_plane) {
    constexpr double step = 1e-5;
    Tensor3<double> h{};
    for (int j = 0; j < 3; ++j) {
        const Vec3 e = step * Vec3::Unit(j);
        const auto u = [&](double steps) { return exact(x + steps * e, is_plane); };
        const Vec3 slope = (8 * (u(1) - u(-1)) - u(2) + u(-2)) / (12 * step);
        for (int i = 0; i < 3; ++i) h.m[3 * i + j] = slope[i];
    }
    return h;
}

/// -Div P of the exact displacement: what must push the body to get there, mN/mm^3.
Vec3 body_force(const SolidMaterial& material, const Vec3& x, bool is_plane) {
    constexpr double step = 1e-3;
    Vec3 force = Vec3::Zero();
    with_material_law<double>(material.law, material.parameters, [&](const auto& law) {
        const auto stress = [&](const Vec3& at) {
            return law.stress(law.state(exact_gradient(at, is_plane)));
        };
        for (int j = 0; j < 3; ++j) {
            const Vec3 e = step * Vec3::Unit(j);
            const auto a = stress(x + e), b = stress(x - e), c = stress(x + 2 * e),
                       d = stress(x - 2 * e);
            for (int i = 0; i < 3; ++i)
                force[i] -=
                    (8 * (a.m[3 * i + j] - b.m[3 * i + j]) - c.m[3 * i + j] + d.m[3 * i + j]) /
                    (12 * step);
        }
    });
    return force;
}

/// mm^3 of an element with straight edges; of a quadrilateral with parallel ones.
double size_of(const SolidMesh& mesh, std::span<const Index> nodes) {
    const auto side = [&](int a) -> Vec3 { return mesh.nodes[nodes[a]] - mesh.nodes[nodes[0]]; };
    if (mesh.type == ElementType::quad4) return side(1).cross(side(3)).norm();
    if (mesh.formulation != Formulation::solid) return 0.5 * side(1).cross(side(2)).norm();
    return side(1).cross(side(2)).dot(side(3)) / 6;
}

/// Calls work(element, N [num_nodes], place, volume) at the points of a rule that is exact to
/// degree 2, whatever the element's own is.
template <class Work>
void at_points(const SolidMesh& mesh, Work&& work) {
    const bool is_solid = mesh.formulation == Formulation::solid;
    const ElementTable& rule =
        mesh.type == ElementType::quad4
            ? mesh.table()
            : element_table(is_solid ? ElementType::tet10 : ElementType::tri6);
    double whole = 0;
    for (const double weight : rule.weight) whole += weight;
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        const auto nodes = mesh.nodes_of(e);
        for (int q = 0; q < rule.num_points; ++q) {
            const ShapeFunctions at = shape_functions(mesh.type, &rule.place[rule.dimension * q]);
            Vec3 place = Vec3::Zero();
            for (std::size_t a = 0; a < nodes.size(); ++a)
                place += at.value[a] * mesh.nodes[nodes[a]];
            work(nodes, at.value, place, rule.weight[q] / whole * size_of(mesh, nodes));
        }
    }
}

/// Error of the displacement in the L2 norm, mm.
double error_on(const SolidMesh& mesh, const SolidMaterial& material) {
    const bool is_plane = mesh.formulation != Formulation::solid;
    SolidModel model{mesh, {material}, {}};
    model.prescribed.assign(3 * mesh.nodes.size(), 0);
    hold_in_plane(model);
    SolidLoads loads{Eigen::VectorXd::Zero(model.num_dofs()),
                     Eigen::VectorXd::Zero(model.num_dofs())};
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const Vec3& x = mesh.nodes[n];
        loads.displacement.segment<3>(3 * n) = exact(x, is_plane);
        const double lowest = is_plane ? x.head<2>().minCoeff() : x.minCoeff();
        if (lowest < 1e-9 || x.maxCoeff() > 1 - 1e-9) std::fill_n(&model.prescribed[3 * n], 3, 1);
    }
    at_points(mesh, [&](auto nodes, const double* value, const Vec3& place, double volume) {
        const Vec3 force = volume * body_force(material, place, is_plane);
        for (std::size_t a = 0; a < nodes.size(); ++a)
            loads.force.segment<3>(3 * nodes[a]) += value[a] * force;
    });
    const Equilibrium found = solve_equilibrium(SolidAssembly(model), loads, {});
    EXPECT_TRUE(found.converged) << found.message;
    double sum = 0;
    at_points(mesh, [&](auto nodes, const double* value, const Vec3& place, double volume) {
        Vec3 u = Vec3::Zero();
        for (std::size_t a = 0; a < nodes.size(); ++a)
            u += value[a] * found.displacement.segment<3>(3 * nodes[a]);
        sum += volume * (u - exact(place, is_plane)).squaredNorm();
    });
    return std::sqrt(sum);
}

struct Order {
    const char* name;
    SolidMaterial material;
    ElementType type;
    std::vector<Index> cells;
    double expected;
};

SolidMesh mesh_of(ElementType type, Index cells) {
    const bool is_quadratic = type == ElementType::tet10 || type == ElementType::tri6;
    SolidMesh mesh;
    if (element_table(type).dimension == 3) {
        mesh = solid_mesh_of(fixtures::box_mesh({cells, cells, cells}, Vec3(1, 1, 1)));
    } else {
        mesh = fixtures::rectangle_mesh(type == ElementType::quad4 ? type : ElementType::tri3,
                                        Formulation::plane_strain, {cells, cells}, {1.0, 1.0});
    }
    return is_quadratic ? with_edge_nodes(mesh) : mesh;
}

class ManufacturedSolution : public testing::TestWithParam<Order> {};

INSTANTIATE_TEST_SUITE_P(
    Orders, ManufacturedSolution, testing::ValuesIn([] {
        const SolidMaterial linear{"linear", {10, 0.3}}, neo_hookean{"neo-hookean", {10, 0.3}};
        return std::vector<Order>{
            {"Tet4Linear", linear, ElementType::tet4, {4, 6, 8, 12}, 1.9},
            {"Tet4NeoHookean", neo_hookean, ElementType::tet4, {4, 6, 8, 12}, 1.9},
            {"Tet10Linear", linear, ElementType::tet10, {2, 3, 4, 6}, 2.8},
            {"Tet10NeoHookean", neo_hookean, ElementType::tet10, {2, 3, 4, 6}, 2.8},
            {"Tri3Linear", linear, ElementType::tri3, {8, 12, 16, 24}, 1.9},
            {"Tri3NeoHookean", neo_hookean, ElementType::tri3, {8, 12, 16, 24}, 1.9},
            {"Tri6Linear", linear, ElementType::tri6, {4, 6, 8, 12}, 2.8},
            {"Tri6NeoHookean", neo_hookean, ElementType::tri6, {4, 6, 8, 12}, 2.8},
            {"Quad4Linear", linear, ElementType::quad4, {8, 12, 16, 24}, 1.9},
            {"Quad4NeoHookean", neo_hookean, ElementType::quad4, {8, 12, 16, 24}, 1.9}};
    }()),
    [](const auto& order) { return order.param.name; });

// The order between the two finest of four meshes.
TEST_P(ManufacturedSolution, IsApproachedWithTheOrderOfTheElement) {
    std::vector<double> errors;
    for (const Index cells : GetParam().cells) {
        errors.push_back(error_on(mesh_of(GetParam().type, cells), GetParam().material));
    }
    const std::size_t last = errors.size() - 1;
    const double order = std::log(errors[last - 1] / errors[last]) /
                         std::log(double(GetParam().cells[last]) / GetParam().cells[last - 1]);
    RecordProperty("order", std::to_string(order));
    EXPECT_GE(order, GetParam().expected)
        << errors[0] << " " << errors[1] << " " << errors[2] << " " << errors[3];
    EXPECT_LT(errors[last], 0.02 * amplitude_mm);
}

}  // namespace
}  // namespace palpate
