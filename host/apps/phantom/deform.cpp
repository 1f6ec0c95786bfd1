// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/deform.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "host/io/label_image.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/newton.hpp"
#include "solver/equilibrium/rest_solver.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/tet4_model.hpp"

namespace palpate {
namespace {

/// Gradients of the four shape functions of a tet (columns), 1/mm.
Eigen::Matrix<double, 3, 4> shape_gradients(const Mesh& mesh, Index tet) {
    const Tet& t = mesh.tets[tet];
    Mat3 edges;
    for (int c = 0; c < 3; ++c) edges.col(c) = mesh.nodes[t[c + 1]] - mesh.nodes[t[0]];
    Eigen::Matrix<double, 3, 4> gradients;
    gradients.rightCols<3>() = edges.inverse().transpose();
    gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
    return gradients;
}

Mat3 displacement_gradient(const Mesh& mesh, Index tet, const std::vector<Vec3>& u) {
    const auto gradients = shape_gradients(mesh, tet);
    Mat3 gradient = Mat3::Zero();
    for (int c = 0; c < 4; ++c) gradient += u[mesh.tets[tet][c]] * gradients.col(c).transpose();
    return gradient;
}

constexpr double least_jacobian = 0.2;

double smallest_jacobian(const std::vector<Mat3>& gradients, double scale) {
    double smallest = std::numeric_limits<double>::max();
    for (const Mat3& gradient : gradients) {
        smallest = std::min(smallest, (Mat3::Identity() + scale * gradient).determinant());
    }
    return smallest;
}

std::vector<Mat3> displacement_gradients(const Mesh& mesh, const std::vector<Vec3>& u) {
    std::vector<Mat3> gradients(mesh.tets.size());
    for (Index t = 0; t < mesh.num_tets(); ++t) gradients[t] = displacement_gradient(mesh, t, u);
    return gradients;
}

void scale_load(const Mesh& mesh, Deformation& deformation) {
    constexpr double step = 0.95;
    const auto gradients = displacement_gradients(mesh, deformation.displacement);
    deformation.smallest_jacobian = smallest_jacobian(gradients, deformation.load_scale);
    while (deformation.smallest_jacobian <= least_jacobian) {
        deformation.load_scale *= step;
        deformation.smallest_jacobian = smallest_jacobian(gradients, deformation.load_scale);
    }
    for (Vec3& u : deformation.displacement) u *= deformation.load_scale;
}

std::vector<Vec3> as_points(const Eigen::VectorXd& values) {
    std::vector<Vec3> points(values.size() / 3);
    for (std::size_t n = 0; n < points.size(); ++n) points[n] = values.segment<3>(3 * n);
    return points;
}

/// The problem with the elements that the truth is solved on.
SolidModel solid_model_of(const WallProblem& problem, const SolidMesh& elements,
                          const std::string& law) {
    SolidModel solid = solid_model_of(problem.model, law);
    solid.mesh = elements;
    return solid;
}

std::vector<Deformation> deform_linear(const WallProblem& problem, const SolidMesh& elements,
                                       double load_factor, const LinearSolverOptions& options,
                                       const ProgressSink& progress) {
    const SolidModel model = solid_model_of(problem, elements, "linear");
    LinearSolverOptions for_elements = options;
    // Conjugate gradients take tet4.
    if (elements.type != ElementType::tet4) for_elements.method = LinearMethod::automatic;
    Columns u;
    const LinearSolverSummary solve =
        make_rest_solver(model, for_elements)->solve(problem.prescribed_mm, u, progress);
    if (!solve.converged) {
        throw Error(ErrorCode::solve_failed,
                    "The phantom's true displacement could not be solved for: " + solve.message +
                        " Try --linear-solver direct or fewer nodes.");
    }
    const SolidAssembly solid(model);
    std::vector<Deformation> deformations(u.cols());
    for (Eigen::Index load = 0; load < u.cols(); ++load) {
        Deformation& deformation = deformations[load];
        deformation.relative_residual = solve.relative_residual;
        deformation.displacement = as_points(u.col(load));
        deformation.load_scale = load_factor;
        scale_load(problem.model.mesh, deformation);
        deformation.force =
            as_points(solid.internal_force(deformation.load_scale * u.col(load)).force);
    }
    return deformations;
}

Deformation deform_finite(const WallProblem& problem, const SolidMesh& elements, Eigen::Index load,
                          const TissueLaw& law, double load_factor,
                          const LinearSolverOptions& options, const ProgressSink& progress) {
    constexpr double step = 0.95, least_scale = 0.05;
    const SolidAssembly solid(solid_model_of(problem, elements, law.name),
                              {options.backend, options.device});
    EquilibriumOptions solve;
    solve.linear = matrix_solver_options(options);
    const Eigen::VectorXd motion = problem.prescribed_mm.col(load);
    SolidLoads loads{motion, Eigen::VectorXd::Zero(problem.model.num_dofs())};
    Deformation deformation;
    deformation.load_scale = load_factor;
    std::string message = "elements are crushed";
    for (; std::abs(deformation.load_scale) >= least_scale * std::abs(load_factor);
         deformation.load_scale *= step) {
        loads.displacement = deformation.load_scale * motion;
        const Equilibrium state = solve_equilibrium(solid, loads, solve, {}, progress);
        message = state.message;
        if (!state.converged) continue;
        deformation.displacement = as_points(state.displacement);
        deformation.smallest_jacobian = smallest_jacobian(
            displacement_gradients(problem.model.mesh, deformation.displacement), 1);
        if (deformation.smallest_jacobian <= least_jacobian) continue;
        deformation.relative_residual = state.relative_residual;
        deformation.force = as_points(solid.internal_force(state.displacement).force);
        return deformation;
    }
    throw Error(ErrorCode::solve_failed,
                "The phantom's true displacement could not be solved for at large deformation: " +
                    message + ". Try fewer nodes or a smaller --load-factor.");
}

}  // namespace

RegionMesh linear_pieces_of(const BodyMesh& body) {
    return {linear_mesh_of(body.mesh), body.surface};
}

std::vector<std::uint8_t> nodes_on_region(const RegionMesh& mesh, Index region) {
    std::vector<std::uint8_t> on_region(mesh.mesh.nodes.size(), 0);
    for (Index t = 0; t < mesh.surface.num_triangles(); ++t) {
        const auto& [behind, in_front] = mesh.surface.regions[t];
        if (behind != region && in_front != region) continue;
        for (const Index node : mesh.surface.triangles[t]) on_region[node] = 1;
    }
    return on_region;
}

WallProblem make_wall_problem(const RegionMesh& mesh, const std::vector<LinearElastic>& materials,
                              const std::vector<WallMotion>& motions) {
    WallProblem problem;
    Model& model = problem.model;
    model = {mesh.mesh, materials, std::vector<std::uint8_t>(3 * mesh.mesh.nodes.size(), 0)};
    problem.prescribed_mm = Columns::Zero(model.num_dofs(), 1);
    const auto prescribe = [&](Index region, const auto& displacement_at) {
        const auto on_region = nodes_on_region(mesh, region);
        for (Index n = 0; n < mesh.mesh.num_nodes(); ++n) {
            if (!on_region[n]) continue;
            const Vec3 u = displacement_at(mesh.mesh.nodes[n]);
            for (int c = 0; c < 3; ++c) {
                model.prescribed[3 * n + c] = 1;
                problem.prescribed_mm(3 * n + c, 0) = u[c];
            }
        }
    };
    const auto at_rest = [](const Vec3&) -> Vec3 { return Vec3::Zero(); };
    for (const WallMotion& motion : motions) {
        prescribe(first_organ_region + motion.organ(),
                  [&](const Vec3& x) { return motion.displacement(x); });
    }
    prescribe(outside_region, at_rest);
    prescribe(first_organ_region + bone_left, at_rest);
    prescribe(first_organ_region + bone_right, at_rest);
    return problem;
}

std::vector<Deformation> deform_by_walls(const BodyMesh& body,
                                         const std::vector<LinearElastic>& materials,
                                         const std::vector<std::vector<WallMotion>>& loads,
                                         double load_factor, const TissueLaw& law,
                                         const LinearSolverOptions& options,
                                         const ProgressSink& progress) {
    const RegionMesh pieces = linear_pieces_of(body);
    WallProblem problem = make_wall_problem(pieces, materials, loads.front());
    problem.prescribed_mm.conservativeResize(Eigen::NoChange, Eigen::Index(loads.size()));
    for (std::size_t k = 1; k < loads.size(); ++k)
        problem.prescribed_mm.col(Eigen::Index(k)) =
            make_wall_problem(pieces, materials, loads[k]).prescribed_mm;
    if (law.is_linear()) return deform_linear(problem, body.mesh, load_factor, options, progress);
    std::vector<Deformation> deformations;
    for (Eigen::Index load = 0; load < problem.prescribed_mm.cols(); ++load)
        deformations.push_back(
            deform_finite(problem, body.mesh, load, law, load_factor, options, progress));
    return deformations;
}

}  // namespace palpate
