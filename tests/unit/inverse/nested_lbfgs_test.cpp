// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/nested_lbfgs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "host/geometry/meshing/rasterise.hpp"
#include "host/geometry/surfaces/distance_map.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/direct.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/tet4_model.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

constexpr double box_mm = 40.0;
constexpr double ball_mm = 8.0;  ///< radius
constexpr Index ball_region = first_organ_region;
constexpr Index wall_region = first_organ_region + 1;  ///< hollow, above the box
constexpr Index num_regions = 4;
constexpr double reference_kpa = 10.0;
const Vec3 centre = Vec3::Constant(0.5 * box_mm);

/// A box of 4 mm cells whose cells round the centre are bent into a ball: moving inwards the
/// largest coordinate turns into the distance from the centre.
Mesh box_with_ball() {
    Mesh mesh = fixtures::box_mesh({10, 10, 10}, Vec3::Constant(box_mm));
    for (Vec3& node : mesh.nodes) {
        const Vec3 x = node - centre;
        const double shell = x.cwiseAbs().maxCoeff();
        if (shell == 0) continue;
        const double bend = std::clamp((0.5 * box_mm - shell) / (0.5 * box_mm - ball_mm), 0.0, 1.0);
        node = centre + x * (1 - bend + bend * shell / x.norm());
    }
    std::fill(mesh.region.begin(), mesh.region.end(), background_region);
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        Vec3 middle = Vec3::Zero();
        for (const Index node : mesh.tets[t]) middle += 0.25 * mesh.nodes[node];
        if ((middle - centre).norm() < ball_mm) mesh.region[t] = ball_region;
    }
    return mesh;
}

/// The top face as the surface of the hollow organ above it: its normals point down, out of it.
ObservedSurface top_surface(const Mesh& mesh) {
    ObservedSurface top{wall_region, true, {}, {}};
    std::vector<Index> number(mesh.nodes.size(), -1);
    const auto vertex = [&](Index node) {
        if (number[node] < 0) {
            number[node] = static_cast<Index>(top.node_of.size());
            top.node_of.push_back(node);
            top.surface.vertices.push_back(mesh.nodes[node]);
        }
        return number[node];
    };
    for (const Tet& tet : mesh.tets) {
        std::vector<Index> corners;
        std::copy_if(tet.begin(), tet.end(), std::back_inserter(corners),
                     [&](Index node) { return mesh.nodes[node].z() == box_mm; });
        if (corners.size() != 3) continue;
        const Vec3& a = mesh.nodes[corners[0]];
        const Vec3 normal = (mesh.nodes[corners[1]] - a).cross(Vec3(mesh.nodes[corners[2]] - a));
        if (normal.z() > 0) std::swap(corners[1], corners[2]);
        top.surface.triangles.push_back(
            {vertex(corners[0]), vertex(corners[1]), vertex(corners[2])});
    }
    return top;
}

/// The faces between the ball and what is round it, outward.
ObservedSurface ball_surface(const Mesh& mesh) {
    ObservedSurface ball{ball_region, false, {}, fixtures::interface_nodes(mesh)};
    std::vector<Index> number(mesh.nodes.size(), -1);
    for (std::size_t k = 0; k < ball.node_of.size(); ++k) {
        number[ball.node_of[k]] = static_cast<Index>(k);
        ball.surface.vertices.push_back(mesh.nodes[ball.node_of[k]]);
    }
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        if (mesh.region[t] != ball_region) continue;
        std::vector<Index> corners;
        for (const Index node : mesh.tets[t]) {
            if (number[node] >= 0) corners.push_back(number[node]);
        }
        if (corners.size() != 3) continue;
        const Vec3& a = ball.surface.vertices[corners[0]];
        const Vec3 normal = (ball.surface.vertices[corners[1]] - a)
                                .cross(Vec3(ball.surface.vertices[corners[2]] - a));
        if (normal.dot(a - centre) < 0) std::swap(corners[1], corners[2]);
        ball.surface.triangles.push_back({corners[0], corners[1], corners[2]});
    }
    return ball;
}

/// A stiff ball (region 2, unknown) in a box of 10 kPa that is held at the bottom and the sides;
/// its top is the wall of a hollow organ that pushes.
RecoveryModel ball_in_a_box(double ball_kpa) {
    RecoveryModel recovery;
    Mesh mesh = box_with_ball();
    const auto is_top = [](const Vec3& x) { return x.z() == box_mm; };
    const auto is_held = [](const Vec3& x) {
        const bool at_side = x.x() == 0 || x.x() == box_mm || x.y() == 0 || x.y() == box_mm;
        return at_side || x.z() == 0;
    };
    recovery.fixed = fixtures::select_nodes(mesh, is_held);
    recovery.driven =
        fixtures::select_nodes(mesh, [&](const Vec3& x) { return is_top(x) && !is_held(x); });
    recovery.observed = fixtures::interface_nodes(mesh);
    recovery.surfaces = {ball_surface(mesh), top_surface(mesh)};
    recovery.unknown = {ball_region};
    Model model = fixtures::free_model(
        std::move(mesh), {{1, 0.35}, {reference_kpa, 0.35}, {ball_kpa, 0.4}, {1, 0.35}});
    fixtures::prescribe(model, recovery.fixed);
    fixtures::prescribe(model, recovery.driven);
    recovery.model = solid_model_of(model);
    return recovery;
}

/// The top pushed down by `depth_mm`, most at one side of its middle so that the ball is bent.
std::vector<Vec3> deformed_nodes(const RecoveryModel& recovery, double depth_mm) {
    Columns moved = Columns::Zero(recovery.model.num_dofs(), 1);
    for (const Index node : recovery.driven) {
        const Vec3 x = recovery.model.mesh.nodes[node] / box_mm;
        moved(3 * node + 2, 0) = -depth_mm * std::sin(M_PI * x.x()) * std::sin(M_PI * x.y());
    }
    Columns u;
    make_direct_solver(tet4_model_of(recovery.model), {})->solve(moved, u);
    std::vector<Vec3> nodes = recovery.model.mesh.nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        nodes[n] += u.col(0).segment<3>(3 * static_cast<Index>(n));
    }
    return nodes;
}

/// What an image would show: the hollow organ above the tissue.
std::vector<std::shared_ptr<const TargetShape>> shapes_of(const Mesh& mesh,
                                                          const std::vector<Vec3>& nodes,
                                                          double voxel_mm) {
    ImageGrid grid;
    grid.spacing = Vec3::Constant(voxel_mm);
    grid.origin = Vec3::Constant(0.5 * voxel_mm);
    const Index width = static_cast<Index>(box_mm / voxel_mm);
    grid.size = {width, width, width + static_cast<Index>(10 / voxel_mm)};
    const std::vector<Index> tets = tet_of_voxels(mesh, nodes, grid);
    RegionImage image{grid, std::vector<std::uint8_t>(tets.size(), wall_region)};
    for (std::size_t k = 0; k < tets.size(); ++k) {
        if (tets[k] >= 0) image.voxels[k] = static_cast<std::uint8_t>(mesh.region[tets[k]]);
    }
    const LabelField field(image, num_regions);
    return {std::make_shared<DistanceMap>(field, ball_region),
            std::make_shared<DistanceMap>(field, wall_region)};
}

SurfaceObservations observations_of(const RecoveryModel& recovery,
                                    const std::vector<Vec3>& target_nodes, double voxel_mm = 1.0) {
    const Mesh mesh = linear_mesh_of(recovery.model.mesh);
    ObservationOptions at_nodes;
    at_nodes.over_patches = false;
    return SurfaceObservations(
        recovery, {shapes_of(mesh, mesh.nodes, voxel_mm), shapes_of(mesh, target_nodes, voxel_mm)},
        std::vector<std::uint8_t>(mesh.nodes.size(), 1), at_nodes);
}

Eigen::VectorXd random_direction(Index n) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); }).normalized();
}

struct Scene {
    RecoveryModel recovery = ball_in_a_box(60);
    SurfaceObservations observations = observations_of(recovery, deformed_nodes(recovery, 4));
};

/// Made once: most of the time goes into the distance maps.
const Scene& scene() {
    static const Scene made;
    return made;
}

class NestedGradient : public ::testing::Test {
protected:
    NestedObjective objective{scene().recovery, scene().observations};
    Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, std::log(12.0));
};

/// Slope at 0 by central differences of fourth order. Their steps must be long: distances are
/// interpolated in single precision.
template <typename Function>
double slope_at_zero(const Function& value, double step) {
    return (8 * (value(step) - value(-step)) - (value(2 * step) - value(-2 * step))) / (12 * step);
}

TEST_F(NestedGradient, ForForcesMatchesCentralDifferences) {
    objective.set_moduli(theta);
    const Eigen::VectorXd force = 0.8 * objective.starting_force();
    const Eigen::VectorXd gradient = objective.evaluate(force).force_gradient;
    // Partly along the gradient, so that the slope is large beside the rounding.
    const Eigen::VectorXd direction =
        gradient.normalized() + random_direction(objective.num_forces());
    const auto value = [&](double step) {
        return objective.evaluate(force + step * direction).value_mm2;
    };

    const double slope = gradient.dot(direction);
    const double difference = slope_at_zero(value, 0.003 * force.norm());

    EXPECT_NEAR(slope, difference, 5e-6 * std::abs(difference));  // 1e-6 is that rounding
}

TEST_F(NestedGradient, ForModuliMatchesCentralDifferences) {
    objective.set_moduli(theta);
    const Eigen::VectorXd force = 0.8 * objective.starting_force();
    const auto value = [&](double step) {
        objective.set_moduli(theta.array() + step);
        return objective.evaluate(force).value_mm2;
    };

    const double slope = objective.modulus_gradient(objective.evaluate(force))[0];
    const double difference = slope_at_zero(value, 0.05);

    // Phi hangs on E far less than on the forces: more of the rounding shows.
    EXPECT_NEAR(slope, difference, 1e-5 * std::abs(difference));
}

TEST_F(NestedGradient, CurvatureIsTheSecondDerivativeAtThePerfectFit) {
    // Without residuals the surfaces' own curvature has no weight: Phi(t p) = t^2/2 c.
    const RecoveryModel& recovery = scene().recovery;
    const auto at_rest = observations_of(recovery, recovery.model.mesh.nodes);
    NestedObjective from_rest(recovery, at_rest);
    from_rest.set_moduli(theta);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(from_rest.num_forces());
    const Eigen::VectorXd direction = random_direction(from_rest.num_forces());

    const double curvature = from_rest.curvature(from_rest.evaluate(rest), direction);
    const double value = from_rest.evaluate(direction).value_mm2;

    EXPECT_NEAR(curvature, 2 * value, 0.01 * curvature);
}

TEST_F(NestedGradient, StartingForcesPutTheWallNearItsTarget) {
    objective.set_moduli(theta);
    const auto wall_misfit = [&](const Eigen::VectorXd& force) {
        const NestedState state = objective.evaluate(force);
        double sum = 0;
        for (const Index node : scene().recovery.driven) {
            sum += state.gradient.segment<3>(3 * node).squaredNorm();
        }
        return sum;
    };

    const double at_rest = wall_misfit(Eigen::VectorXd::Zero(objective.num_forces()));
    EXPECT_LT(wall_misfit(objective.starting_force()), 0.01 * at_rest);
}

TEST(NestedObjective, RefusesAModelThatCouldFloat) {
    RecoveryModel recovery = scene().recovery;
    recovery.fixed.clear();

    EXPECT_THROW(NestedObjective(recovery, scene().observations), Error);
}

TEST(NestedLbfgs, RecoversAModulusOnTheSameMesh) {
    const double truth_kpa = 40;
    const RecoveryModel truth = ball_in_a_box(truth_kpa);
    const RecoveryModel recovery = ball_in_a_box(25);
    const auto observations = observations_of(recovery, deformed_nodes(truth, 8), 0.5);

    const NestedEstimate found = nested_lbfgs(recovery, observations, {});

    ASSERT_EQ(found.unknown, std::vector<Index>{ball_region});
    std::printf("    %.1f kPa after %d sets of moduli, %ld inner iterations, %ld solves: %s\n",
                std::exp(found.theta[0]), found.termination.iterations, found.inner_iterations,
                found.solves, found.termination.reason.c_str());
    // Without a prior the noise of the voxels goes into the modulus: 40 +- 10 % at best.
    EXPECT_NEAR(std::exp(found.theta[0]), truth_kpa, 0.1 * truth_kpa);
    EXPECT_TRUE(found.termination.converged);
    EXPECT_EQ(found.driven_force.size(), 3 * static_cast<Index>(recovery.driven.size()));
    EXPECT_GT(found.solves, 2 * found.inner_iterations);
}

TEST(NestedLbfgs, StopsAtItsTimeLimitWithAUsableState) {
    NestedOptions options;
    options.time_limit_s = 0.05;

    const NestedEstimate found = nested_lbfgs(scene().recovery, scene().observations, options);

    EXPECT_FALSE(found.termination.converged);
    EXPECT_EQ(found.displacement.size(), scene().recovery.model.num_dofs());
    EXPECT_EQ(found.theta.size(), 1);
    EXPECT_FALSE(found.records.empty());
}

}  // namespace
}  // namespace palpate
