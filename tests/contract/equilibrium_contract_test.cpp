// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "solver/adjoint/solid_adjoint.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/newton.hpp"
#include "solver/linear/matrix_solver.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/surface_load.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

// Equilibrium with conjugate gradients on every back end against equilibrium with a factorisation.
namespace palpate {
namespace {

using namespace fixtures;

constexpr double same_place = 1e-8;

std::vector<MatrixSolverOptions> every_solver() {
    std::vector<MatrixSolverOptions> list;
    for (const std::string& name : backend_names())
        for (const LinearMethod method : {LinearMethod::multigrid, LinearMethod::jacobi})
            list.push_back({.method = method, .backend = name});
    // Multigrid in single within conjugate gradients in double.
    list.push_back({.method = LinearMethod::multigrid,
                    .backend = backend_names().front(),
                    .device = {Precision::double_, {}, ""}});
    return list;
}

std::string solver_name(const testing::TestParamInfo<MatrixSolverOptions>& entry) {
    const bool is_double = entry.param.device.precision == Precision::double_;
    return entry.param.backend + "_" + name_of(entry.param.method) + (is_double ? "_double" : "");
}

class EquilibriumContract : public testing::TestWithParam<MatrixSolverOptions> {
protected:
    void SetUp() override {
        if (const auto reason = reason_to_skip(GetParam().backend, GetParam().device))
            GTEST_SKIP() << *reason;
        by_gradients.linear = GetParam();
        for (EquilibriumOptions* options : {&by_gradients, &by_factor})
            options->relative_tolerance = 1e-11;
    }

    /// Both ways lead to one place.
    void expect_same(const LoadedModel& work, const std::string& name) const {
        const SolidAssembly solid(work.model);
        const Equilibrium expected = solve_equilibrium(solid, work.loads, by_factor);
        ASSERT_TRUE(expected.converged) << name << ": " << expected.message;

        const Equilibrium found = solve_equilibrium(solid, work.loads, by_gradients);

        ASSERT_TRUE(found.converged) << name << ": " << found.message;
        EXPECT_LE((found.displacement - expected.displacement).norm(),
                  same_place * expected.displacement.norm())
            << name;
    }

    EquilibriumOptions by_gradients, by_factor;
};

/// Some thousand dofs: two levels of multigrid at least.
SolidMesh box_of(bool is_quadratic) {
    const Index cells = is_quadratic ? 3 : 6;
    const SolidMesh mesh = solid_mesh_of(box_mesh({cells, cells, cells}, Vec3(2, 2, 2)));
    return is_quadratic ? with_edge_nodes(mesh) : mesh;
}

TEST_P(EquilibriumContract, EveryLawComesToWhereTheFactorLeads) {
    for (const bool is_quadratic : {false, true})
        for (const SolidMaterial& material : solid_materials())
            expect_same(
                between_plates(solid_model(box_of(is_quadratic), material), Vec3(0.1, 0, -0.2)),
                material.law + (is_quadratic ? " tet10" : " tet4"));
}

TEST_P(EquilibriumContract, PlanesAndAxesToo) {
    for (const Formulation formulation :
         {Formulation::plane_strain, Formulation::plane_stress, Formulation::axisymmetric})
        for (const ElementType type : {ElementType::tri3, ElementType::quad4}) {
            const SolidMesh mesh = rectangle_mesh(type, formulation, {18, 16}, {3.0, 2.0});
            expect_same(pulled(solid_model(mesh, solid_materials()[1])),
                        mesh.table().name + " " + name_of(formulation));
        }
}

TEST_P(EquilibriumContract, NearlyIncompressibleMatterOfMeanVolume) {
    SolidModel model = solid_model(box_of(true), {"neo-hookean", {10, 0.4999}});
    model.volume = VolumeTreatment::element_mean;

    expect_same(between_plates(model, Vec3(0, 0, -0.1)), "nu 0.4999");
}

// Conjugate gradients see the symmetric half of its tangent and precondition the whole.
TEST_P(EquilibriumContract, APressureThatFollowsASurfaceWithAFreeEdge) {
    for (const bool is_quadratic : {false, true}) {
        LoadedModel work =
            between_plates(solid_model(box_of(is_quadratic), solid_materials()[1]), Vec3::Zero());
        const SolidMesh& mesh = work.model.mesh;
        for (Index n = 0; n < mesh.num_nodes(); ++n)
            if (mesh.nodes[n].z() > 1) std::fill_n(&work.model.prescribed[3 * n], 3, 0);
        work.model.pressures = {
            {boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].x() > 2 - 1e-9; })}};
        work.loads.pressure_kpa = {1};
        expect_same(work, is_quadratic ? "tet10" : "tet4");
    }
}

// Dead loads of a third of the shear modulus and more, from where Newton alone loses its way.
TEST_P(EquilibriumContract, ALargePressureIsReachedThroughTangentsThatAreNotDefinite) {
    for (const double pressure : {5.0, 30.0}) {
        LoadedModel work =
            between_plates(solid_model(solid_meshes()[0], solid_materials()[1]), Vec3::Zero());
        const auto is_above = [&](double z) {
            return [&, z](Index n) { return work.model.mesh.nodes[n].z() > z; };
        };
        for (Index n = 0; n < work.model.mesh.num_nodes(); ++n)
            if (is_above(1)(n)) std::fill_n(&work.model.prescribed[3 * n], 3, 0);
        work.loads.force =
            traction_forces(work.model.mesh, boundary_faces(work.model.mesh, is_above(2 - 1e-9)),
                            [&](const Vec3&, const Vec3& n) { return -pressure * n; });
        const SolidAssembly solid(work.model);

        const Equilibrium found = solve_equilibrium(solid, work.loads, by_gradients);

        ASSERT_TRUE(found.converged) << pressure << " kPa: " << found.message;
        // Several equilibria exist; a factor says whether this one is stable.
        TangentSolve tangent(solid, {});
        EXPECT_TRUE(tangent.factorise(found.displacement)) << pressure << " kPa";
        EXPECT_LE(found.relative_residual, by_gradients.relative_tolerance);
    }
}

TEST_P(EquilibriumContract, GradientsAreThoseOfTheFactor) {
    const LoadedModel work =
        between_plates(solid_model(box_of(false), solid_materials()[1]), Vec3(0, 0, -0.2));
    const SolidAssembly solid(work.model);
    const Eigen::VectorXd slope = random_columns(work.model.num_dofs(), 1, 3).col(0);
    const auto gradient_with = [&](const EquilibriumOptions& options) {
        const Equilibrium found = solve_equilibrium(solid, work.loads, options);
        return solid_gradient(solid, found, slope).force;
    };

    const Eigen::VectorXd expected = gradient_with(by_factor);
    const Eigen::VectorXd found = gradient_with(by_gradients);

    EXPECT_LE((found - expected).norm(), same_place * expected.norm());
}

TEST_P(EquilibriumContract, ABodyThatIsNotHeldIsSaid) {
    LoadedModel work{solid_model(solid_meshes()[0], solid_materials()[1]), {}};
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setOnes(work.model.num_dofs());
    by_gradients.smallest_step = 0.5;
    by_gradients.max_newton_steps = 10;

    EXPECT_FALSE(solve_equilibrium(SolidAssembly(work.model), work.loads, by_gradients).converged);
}

/// K - c I with c between its lowest eigenvalues and the others, at free dofs.
BlockMatrix with_negative_curvature(BlockMatrix matrix, const MatrixSolverMesh& mesh) {
    const auto factor = make_factor_solver(mesh, {});
    factor->set(matrix, 0);
    Eigen::MatrixXd slowest = Eigen::MatrixXd::Ones(mesh.prescribed.size(), 1);
    double size = 0;
    for (int step = 0; step < 10; ++step) {
        Eigen::MatrixXd next = Eigen::MatrixXd::Zero(slowest.rows(), 1);
        factor->solve(slowest, next);
        size = next.norm();
        slowest = next / size;
    }
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
            for (int i = 0; i < 3 && matrix.graph.items[k] == n; ++i)
                matrix.block(k)[4 * i] -= 1.5 / size;
    return matrix;
}

TEST_P(EquilibriumContract, NegativeCurvatureIsSeenAndRemembered) {
    const SolidModel model =
        between_plates(solid_model(box_of(false), solid_materials()[1]), Vec3::Zero()).model;
    const SolidAssembly solid(model);
    BlockMatrix matrix = solid.make_matrix();
    solid.tangent(Eigen::VectorXd::Zero(model.num_dofs()), matrix);
    const MatrixSolverMesh mesh{model.mesh.nodes, model.prescribed, matrix.graph};
    const BlockMatrix bad = with_negative_curvature(matrix, mesh);
    const Eigen::MatrixXd right = random_columns(model.num_dofs(), 1, 5);
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(right.rows(), 1);
    const auto solver = make_matrix_solver(mesh, GetParam());

    ASSERT_TRUE(solver->set(matrix, 0) && solver->solve(right, x)) << solver->failure();
    EXPECT_FALSE(solver->set(bad, 0) && solver->solve(right, x));
    EXPECT_TRUE(solver->is_indefinite());
    EXPECT_NE(solver->failure().find("positive definite"), std::string::npos);
    EXPECT_FALSE(solver->set(bad, 0)) << "looked for where it was";
    EXPECT_TRUE(solver->set(bad, 1) && solver->solve(right, x)) << solver->failure();
    EXPECT_FALSE(solver->set(bad, 0)) << "a shift changes nothing of that";
    EXPECT_TRUE(solver->set(matrix, 0) && solver->solve(right, x)) << solver->failure();
}

TEST_P(EquilibriumContract, TooFewIterationsAreSaid) {
    by_gradients.linear.max_iterations = 2;
    const LoadedModel work =
        between_plates(solid_model(box_of(false), solid_materials()[1]), Vec3(0, 0, -0.2));

    const Equilibrium found =
        solve_equilibrium(SolidAssembly(work.model), work.loads, by_gradients);

    EXPECT_FALSE(found.converged);
    EXPECT_NE(found.message.find("2 conjugate gradients"), std::string::npos) << found.message;
}

INSTANTIATE_TEST_SUITE_P(EverySolver, EquilibriumContract, testing::ValuesIn(every_solver()),
                         solver_name);

/// Plates 0.2 mm closer; `cells` per edge.
LoadedModel pressed_box(Index cells) {
    return between_plates(solid_model(solid_mesh_of(box_mesh({cells, cells, cells}, Vec3(2, 2, 2))),
                                      solid_materials()[1]),
                          Vec3(0, 0, -0.2));
}

constexpr Index few_cells = 4, many_cells = 14;  // 375 and 10,125 degrees of freedom

LinearSolverInfo solver_of(const LoadedModel& work, const MatrixSolverOptions& linear) {
    EquilibriumOptions options;
    options.linear = linear;
    const SolidAssembly solid(work.model);
    const Equilibrium found = solve_equilibrium(solid, work.loads, options);
    EXPECT_TRUE(found.converged) << found.message;
    return found.tangent->solver();
}

TEST(AutomaticEquilibrium, FactorisesSmallSystemsWithoutADevice) {
    const LinearSolverInfo used = solver_of(
        pressed_box(few_cells), {.method = LinearMethod::automatic, .backend = "no such back end"});

    EXPECT_EQ(used.method, LinearMethod::direct);
    EXPECT_EQ(used.device.device, "host");
    EXPECT_NE(used.reason.find("375 degrees"), std::string::npos) << used.reason;
}

TEST(AutomaticEquilibrium, TakesTheDeviceForLargeOnes) {
    const std::string backend = backend_names().front();
    if (const auto reason = reason_to_skip(backend, {})) GTEST_SKIP() << *reason;

    const LinearSolverInfo used =
        solver_of(pressed_box(many_cells), {.method = LinearMethod::automatic, .backend = backend});

    EXPECT_EQ(used.method, LinearMethod::multigrid);
    EXPECT_EQ(used.device.backend, backend);
}

TEST(AutomaticEquilibrium, FactorisesPlaneMeshesOfAnySize) {
    const SolidMesh mesh =
        rectangle_mesh(ElementType::quad4, Formulation::axisymmetric, {60, 60}, {3.0, 2.0});
    ASSERT_GT(3 * mesh.num_nodes(), 10000);

    const LinearSolverInfo used =
        solver_of(pulled(solid_model(mesh, solid_materials()[1])),
                  {.method = LinearMethod::automatic, .backend = backend_names().front()});

    EXPECT_EQ(used.method, LinearMethod::direct);
    EXPECT_NE(used.reason.find("cheapest"), std::string::npos) << used.reason;
}

TEST(AutomaticEquilibrium, FactorisesWhereThereIsNoSuchDevice) {
    if (backend_names().front() != "opencl") GTEST_SKIP() << "OpenCL is not in this build";

    const LinearSolverInfo used = solver_of(
        pressed_box(many_cells),
        {.method = LinearMethod::automatic, .device = {.device = "no device has this name"}});

    EXPECT_EQ(used.method, LinearMethod::direct);
    EXPECT_NE(used.reason.find("no device"), std::string::npos) << used.reason;
}

TEST(AutomaticEquilibrium, FactorisesWhereConjugateGradientsFail) {
    const std::string backend = backend_names().front();
    if (const auto reason = reason_to_skip(backend, {})) GTEST_SKIP() << *reason;

    const LinearSolverInfo used =
        solver_of(pressed_box(many_cells),
                  {.method = LinearMethod::automatic, .backend = backend, .max_iterations = 2});

    EXPECT_EQ(used.method, LinearMethod::direct);
    EXPECT_NE(used.reason.find("2 conjugate gradients"), std::string::npos) << used.reason;
}

class ElementLoopsContract : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        if (const auto reason = reason_to_skip(GetParam(), {Precision::double_, {}, ""}))
            GTEST_SKIP() << *reason;
        options.backend = GetParam();
        options.is_by_name = true;
    }

    ElementLoopOptions options;
};

TEST_P(ElementLoopsContract, AreThoseOfTheHost) {
    for (const SolidMaterial& material : solid_materials()) {
        const LoadedModel work = between_plates(solid_model(box_of(true), material), Vec3::Zero());
        const SolidAssembly host(work.model), device(work.model, options);
        const Eigen::VectorXd u = 0.02 * random_columns(work.model.num_dofs(), 1, 3).col(0);
        const Eigen::VectorXd lambda = random_columns(work.model.num_dofs(), 1, 4).col(0);
        BlockMatrix expected = host.make_matrix(), found = device.make_matrix();
        const InternalForce of_host = host.internal_force(u), of_device = device.internal_force(u);
        host.tangent(u, expected);
        device.tangent(u, found);

        EXPECT_EQ(device.loops().device.backend, GetParam());
        EXPECT_NEAR(of_device.energy, of_host.energy, 1e-9 * of_host.energy);
        EXPECT_LE((of_device.force - of_host.force).norm(), 1e-9 * of_host.force.norm());
        const auto blocks = [](const BlockMatrix& matrix) {
            return Eigen::Map<const Eigen::VectorXd>(matrix.blocks.data(), matrix.blocks.size());
        };
        EXPECT_LE((blocks(found) - blocks(expected)).norm(), 1e-9 * blocks(expected).norm());
        const auto slopes = host.parameter_products(u, lambda);
        EXPECT_NEAR(device.parameter_products(u, lambda)[0][0], slopes[0][0],
                    1e-9 * std::abs(slopes[0][0]))
            << material.law;
    }
}

TEST_P(ElementLoopsContract, LeadToTheSameEquilibrium) {
    for (const bool has_mean_volume : {false, true}) {
        LoadedModel work = pressed_box(few_cells);
        if (has_mean_volume)
            work = between_plates(solid_model(box_of(true), {"neo-hookean", {10, 0.499}}),
                                  Vec3(0, 0, -0.1));
        if (has_mean_volume) work.model.volume = VolumeTreatment::element_mean;
        const SolidAssembly host(work.model), device(work.model, options);

        const Equilibrium expected = solve_equilibrium(host, work.loads, {});
        const Equilibrium found = solve_equilibrium(device, work.loads, {});

        ASSERT_TRUE(found.converged) << found.message;
        EXPECT_EQ(device.loops().device.backend, GetParam());
        EXPECT_LE((found.displacement - expected.displacement).norm(),
                  same_place * expected.displacement.norm())
            << (has_mean_volume ? "mean volume" : "pointwise");
    }
}

TEST_P(ElementLoopsContract, TheHostDoesWhatADeviceCannotAndSaysSo) {
    if (GetParam() != "reference") {
        const SolidAssembly in_plane_stress(solid_model(solid_meshes()[2], solid_materials()[1]),
                                            options);
        EXPECT_EQ(in_plane_stress.loops().device.device, "host");
        EXPECT_NE(in_plane_stress.loops().reason.find("plane stress"), std::string::npos);
    }

    SolidModel model = pressed_box(few_cells).model;
    model.materials[0].relaxation = {{0.5, 1.0}};
    EXPECT_NE(SolidAssembly(model, options).loops().reason.find("relaxation"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, ElementLoopsContract, testing::ValuesIn(backend_names()));

TEST(ElementLoops, SmallMeshesStayOnTheHostUnlessABackEndIsNamed) {
    const SolidModel model = pressed_box(few_cells).model;

    const SolidAssembly solid(model, {"no such back end", {}, false});

    EXPECT_EQ(solid.loops().device.device, "host");
    EXPECT_EQ(solid.loops().reason, "a small mesh");
    EXPECT_THROW(SolidAssembly(model, {"no such back end", {}, true}), Error);
}

}  // namespace
}  // namespace palpate
