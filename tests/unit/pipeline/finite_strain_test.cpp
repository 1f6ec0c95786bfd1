// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/finite_strain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <string>

#include "host/apps/recover/inverse/tangent_response.hpp"
#include "host/apps/recover/pipeline/recover.hpp"
#include "host/geometry/surfaces/surface_shape.hpp"
#include "solver/base/error.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/unit/phantom/hollow_block.hpp"

namespace palpate {
namespace {

constexpr double true_kpa = 60;
const Vec3 balloon_centre(14, 20, 20), ball_centre(26, 20, 20);

/// A block of 40 mm with a ball of unknown stiffness beside a balloon that is blown up.
struct Block {
    static Settings two_organs() {
        return parse_settings(
            "[background]\nstiffness_kpa = 10.0\n"
            "[[organ]]\nname = \"ball\"\nlabel = 1\nrole = \"tissue\"\nstiffness_kpa = "
            "\"unknown\"\n"
            "[[organ]]\nname = \"balloon\"\nlabel = 2\nrole = \"driven\"\n",
            "block");
    }
    explicit Block(ElementType type = ElementType::tet4, int cubes = 10)
        : element(type), cells(cubes) {}

    ElementType element;
    int cells;
    Settings settings = two_organs();
    RegionMesh mesh =
        fixtures::region_block({cells, cells, cells}, Vec3::Constant(40),
                               [](const Vec3& x) {
                                   if ((x - ball_centre).norm() < 7) return Index(2);
                                   return (x - balloon_centre).norm() < 6 ? Index(3) : Index(1);
                               },
                               {3});
    Mechanics rest = mechanics();

    static LinearSolverOptions solver() {
        LinearSolverOptions options;
        options.method = LinearMethod::direct;
        return options;
    }
    Mechanics mechanics(double tolerance_mm = 0.001) const {
        StageTimer timer;
        MechanicsOptions options;
        options.response.tolerance_mm = tolerance_mm;
        return make_mechanics(body_mesh(mesh, element), settings, solver(), options, timer);
    }
    SolidModel true_model(const TissueLaw& law = {"neo-hookean"}) const {
        SolidModel model = with_law(rest.recovery.model, law);
        set_stiffness(model, 2, true_kpa);
        return model;
    }
    /// [3 num_nodes] mm: the body with the balloon's wall moved outward.
    Eigen::VectorXd blown_up(double mm, const TissueLaw& law = {"neo-hookean"}) const {
        const SolidModel model = true_model(law);
        SolidLoads loads{Eigen::VectorXd::Zero(model.num_dofs()),
                         Eigen::VectorXd::Zero(model.num_dofs())};
        for (const Index node : rest.recovery.driven)
            loads.displacement.segment<3>(3 * node) =
                mm * (model.mesh.nodes[node] - balloon_centre).normalized();
        const SolidAssembly solid(model);
        const Equilibrium state = solve_equilibrium(solid, loads, {});
        EXPECT_TRUE(state.converged) << state.message;
        return state.displacement;
    }
    SurfaceObservations observations(const Eigen::VectorXd& u, double noise_mm) const {
        ObservedShapes shapes;
        for (const ObservedSurface& organ : rest.recovery.surfaces) {
            Surface moved = organ.surface;
            for (std::size_t v = 0; v < moved.vertices.size(); ++v)
                moved.vertices[v] += u.segment<3>(3 * organ.node_of[v]);
            shapes.reference.push_back(std::make_shared<SurfaceShape>(organ.surface));
            shapes.target.push_back(std::make_shared<SurfaceShape>(std::move(moved)));
        }
        ObservationOptions options;
        options.noise_mm = noise_mm;
        options.independent_area_mm2 = 1e-6;
        return SurfaceObservations(
            rest.recovery, std::move(shapes),
            std::vector<std::uint8_t>(rest.recovery.model.mesh.nodes.size(), 1), options);
    }
    static TangentOptions tangent_options() {
        TangentOptions options;
        options.solver = solver();
        return options;
    }
    static FiniteStrainOptions options() {
        FiniteStrainOptions options;
        options.search.contour_mm = 0;
        options.search.fit_walls = false;
        options.search.smallest_noise_scale = 0.02;
        options.search.noise_iterations = 3;
        options.tangent_tolerance_mm = 0.005;
        options.solver = solver();
        options.model_sd_ln = 0;
        return options;
    }
};

double percent_off(double kpa, double expected) { return 100 * (kpa / expected - 1); }

TEST(FiniteStrain, FindsTheTruthWhereLinearElasticityDoesNot) {
    const Block block;
    const Eigen::VectorXd truth = block.blown_up(4);
    const auto seen = block.observations(truth, 0.5);

    const auto found =
        search_finite_strain(block.rest, TissueLaw{"neo-hookean"}, seen, Block::options());

    EXPECT_LT(std::abs(percent_off(std::exp(found.estimate.theta[0]), true_kpa)), 3);
    EXPECT_GT(std::abs(percent_off(std::exp(found.first.theta[0]), true_kpa)), 6);
    EXPECT_LE(found.estimate.interval_kpa[0][0], true_kpa);
    EXPECT_GE(found.estimate.interval_kpa[0][1], true_kpa);
    EXPECT_TRUE(found.state.converged);
    EXPECT_LT(found.gap_mm, 0.02);
    EXPECT_LT((found.state.displacement - truth).norm(), 0.2 * truth.norm());
}

/// Laws with kappa/2 (J - 1)^2 do not resist being crushed, so that walls move less than above.
/// Those that stiffen much more are tried on phantoms (tests/cli/test_neo_hookean.py): between
/// cubes and a staircase they are told too soft.
TEST(FiniteStrain, TakesOtherLaws) {
    const Block block;
    for (const char* name : {"neo-hookean-reduced", "yeoh"}) {
        const TissueLaw law = tissue_law_of(name);
        const auto seen = block.observations(block.blown_up(2.5, law), 0.3125);

        const auto found = search_finite_strain(block.rest, law, seen, Block::options());

        EXPECT_LT(std::abs(percent_off(std::exp(found.estimate.theta[0]), true_kpa)), 5) << name;
        EXPECT_LE(found.estimate.interval_kpa[0][0], true_kpa) << name;
        EXPECT_GE(found.estimate.interval_kpa[0][1], true_kpa) << name;
        EXPECT_TRUE(found.state.converged) << name;
        EXPECT_LT(found.gap_mm, 0.02) << name;
    }
}

/// Of cubes the ball is a staircase: 8 cubes along an edge leave 4 %, 6 leave 8 %, 10 leave 1 %.
TEST(FiniteStrain, FindsTheTruthWithQuadraticElements) {
    const Block block(ElementType::tet10, 8);
    const Eigen::VectorXd truth = block.blown_up(3);
    const auto seen = block.observations(truth, 0.5);

    const auto found =
        search_finite_strain(block.rest, TissueLaw{"neo-hookean"}, seen, Block::options());

    EXPECT_LT(std::abs(percent_off(std::exp(found.estimate.theta[0]), true_kpa)), 6);
    EXPECT_GT(std::abs(percent_off(std::exp(found.first.theta[0]), true_kpa)), 12);
    EXPECT_TRUE(found.state.converged);
}

/// With Hooke's law every tangent is that at rest, so that the rounds must find what the search at
/// rest finds.
TEST(FiniteStrain, ChangesNothingForTheLinearLaw) {
    const Block block;
    const auto seen = block.observations(block.blown_up(4), 0.5);
    FiniteStrainOptions options = Block::options();
    options.search.estimate_noise = false;
    options.search.smallest_noise_scale = 1;  // both take the same noise
    options.search.modulus_tolerance_sd = 0.01;

    const auto found = search_finite_strain(block.rest, TissueLaw{}, seen, options);

    const double kpa = std::exp(found.estimate.theta[0]), first = std::exp(found.first.theta[0]);
    EXPECT_LT(std::abs(percent_off(kpa, first)), 2);  // a quarter of its deviation
    EXPECT_LT(found.gap_mm, 0.002);
    for (int end : {0, 1})
        EXPECT_NEAR(found.estimate.interval_kpa[0][end] / found.first.interval_kpa[0][end], 1,
                    0.01);
}

/// u_o of every observed degree of freedom, by dense condensation: no modes, no functionals.
Eigen::MatrixXd exact_answers(const DeformedBody& body, const std::vector<double>& kpa,
                              const Eigen::MatrixXd& walls) {
    const auto n = Eigen::Index(3 * body.observed.size()), d = Eigen::Index(3 * body.driven.size());
    const auto regions = condense_at(body.displacement, body.model, body.observed, body.driven,
                                     Eigen::MatrixXd::Identity(n, n),
                                     Eigen::MatrixXd::Identity(d, d), Block::solver());
    const auto forces = region_forces(body.displacement, body.model, body.observed, body.driven);
    const LinearisationPoint point = point_of(body);
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(n, walls.cols());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const double modulus = kpa[regions[r].region];
        stiffness += modulus * regions[r].stiffness;
        load += modulus * (regions[r].coupling * (walls.colwise() - point.driven));
        load.colwise() += modulus * forces[r].force;
    }
    return (-stiffness.llt().solve(load)).colwise() + point.observed;
}

/// Root mean square over nodes of what a response leaves out, the ball `factor` times as stiff.
double error_mm(const ResponseModel& response, const DeformedBody& body, double factor,
                const Eigen::MatrixXd& walls) {
    std::vector<double> kpa = moduli_of(body.model);
    kpa[2] *= factor;
    const Eigen::MatrixXd exact = exact_answers(body, kpa, walls);
    double squares = 0;
    for (Eigen::Index k = 0; k < walls.cols(); ++k)
        squares += (response.observed_displacement(kpa, walls.col(k)) - exact.col(k)).squaredNorm();
    return std::sqrt(squares / double(body.observed.size() * walls.cols()));
}

TEST(TangentResponse, AnswersAsTheCondensedTangentDoes) {
    const Block block;
    TangentOptions options;
    options.tolerance_mm = 0.02;
    options.solver = Block::solver();
    const Mechanics rest = block.mechanics(options.tolerance_mm);
    const RecoveryModel& recovery = rest.recovery;
    const SolidModel model = block.true_model();
    const DeformedBody body{model, recovery.observed, recovery.driven, block.blown_up(4)};
    const Eigen::MatrixXd walls = rest.walls.samples(3, 77).colwise() + point_of(body).driven;

    const TangentResponse found = tangent_response(body, rest.response, rest.walls, {2}, options);

    EXPECT_EQ(found.reach, options.reach);
    EXPECT_GT(found.left_out_mm, 0);
    EXPECT_LT(found.left_out_mm, 2 * options.tolerance_mm);
    EXPECT_TRUE(found.model.is_diagonal_in(2));
    EXPECT_LT(found.model.num_modes(), found.model.observed_dofs());
    for (const double factor : {0.4, 1.0, 2.5})
        EXPECT_LT(error_mm(found.model, body, factor, walls), 2 * options.tolerance_mm) << factor;

    // 0.3 mm further the modes are a little stale, the tangent is not.
    const DeformedBody near{model, recovery.observed, recovery.driven, block.blown_up(4.3)};
    const Eigen::MatrixXd moved = walls.colwise() + (point_of(near).driven - point_of(body).driven);
    const ResponseModel again = tangent_response_near(near, found.model, {2}, Block::solver());
    for (const double factor : {0.4, 1.0, 2.5})
        EXPECT_LT(error_mm(again, near, factor, moved), 3 * options.tolerance_mm) << factor;
}

/// Two unknown moduli far from those that were tried together.
TEST(TangentResponse, AnswersForEachOfSeveralModuliAlone) {
    const Block block;
    const TangentOptions options = Block::tangent_options();
    const RecoveryModel& recovery = block.rest.recovery;
    const SolidModel model = block.true_model();
    const DeformedBody body{model, recovery.observed, recovery.driven, block.blown_up(4)};
    const Eigen::MatrixXd walls = block.rest.walls.samples(3, 77).colwise() + point_of(body).driven;

    const TangentResponse found =
        tangent_response(body, block.rest.response, block.rest.walls, {1, 2}, options);

    EXPECT_FALSE(found.model.is_diagonal_in(2));
    for (const double factor : {0.4, 2.5})
        EXPECT_LT(error_mm(found.model, body, factor, walls), 3 * options.tolerance_mm) << factor;
}

/// A ball pressed together bears a stress of its own stiffness: the stiffer it is for what
/// surrounds it, the sooner it buckles.
TEST(TangentResponse, StaysNearerWhereTheTangentIsNotStable) {
    const Block block;
    const TangentOptions options = Block::tangent_options();
    const RecoveryModel& recovery = block.rest.recovery;
    const SolidModel model = block.true_model();
    const auto reach_pressed_by = [&](double part) {
        Eigen::VectorXd u(3 * model.mesh.num_nodes());
        for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
            const Vec3 x = model.mesh.nodes[n] - ball_centre;
            u.segment<3>(3 * n) = -part * std::exp(-x.squaredNorm() / 60) * x;
        }
        const DeformedBody body{model, recovery.observed, recovery.driven, u};
        return tangent_response(body, block.rest.response, block.rest.walls, {2}, options).reach;
    };

    EXPECT_EQ(reach_pressed_by(0.02), options.reach);
    EXPECT_LT(reach_pressed_by(0.09), options.reach);
    EXPECT_EQ(fixtures::code_of([&] { reach_pressed_by(0.5); }), ErrorCode::solve_failed);
}

TEST(FiniteStrain, SaysThatItDidNotSettle) {
    const Block block;
    const auto seen = block.observations(block.blown_up(3), 0.5);
    FiniteStrainOptions options = Block::options();
    options.max_rounds = 1;
    options.displacement_tolerance_mm = 1e-9;

    const auto found = search_finite_strain(block.rest, TissueLaw{"neo-hookean"}, seen, options);

    EXPECT_FALSE(found.estimate.termination.converged);
    EXPECT_NE(found.estimate.termination.reason.find("1 rounds of linearisation"),
              std::string::npos);
}

TEST(FiniteStrain, SaysThatThereIsNoEquilibriumWhereMatterWouldInvert) {
    const Block block;
    Eigen::VectorXd crushed = Eigen::VectorXd::Zero(3 * block.mesh.mesh.num_nodes());
    for (const Index node : block.rest.recovery.driven)  // through ball and border of the block
        crushed.segment<3>(3 * node) =
            25 * (block.mesh.mesh.nodes[node] - balloon_centre).normalized();
    const auto seen = block.observations(crushed, 0.02);
    FiniteStrainOptions options = Block::options();
    options.max_rounds = 2;
    options.search.max_iterations = 5;

    try {
        search_finite_strain(block.rest, TissueLaw{"neo-hookean"}, seen, options);
        FAIL() << "an equilibrium of crushed matter";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::solve_failed);
        EXPECT_NE(std::string(error.what()).find("neo-hookean body has no equilibrium"),
                  std::string::npos)
            << error.what();
    }
}

TEST(FiniteStrain, RefusesWhatItCannotDo) {
    const auto refusal = [](const auto& change) -> std::string {
        RecoverOptions options;
        options.law = TissueLaw{"neo-hookean"};
        options.settings = Block().settings;
        change(options);
        try {
            check_tissue_law(options);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            return error.what();
        }
        return "";
    };

    EXPECT_EQ(refusal([](RecoverOptions&) {}), "");
    EXPECT_NE(refusal([](auto& options) {
                  options.method = SearchMethod::nested_lbfgs;
              }).find("--method nested-lbfgs does not go with --material neo-hookean"),
              std::string::npos);
    EXPECT_NE(refusal([](auto& options) {
                  options.settings.organs[0].poisson_unknown = true;
              }).find("poisson_ratio = \"unknown\""),
              std::string::npos);
}

}  // namespace
}  // namespace palpate
