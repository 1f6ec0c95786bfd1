// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/linear_problem.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "host/apps/phantom/random_numbers.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/model/stiffness_matrix.hpp"

namespace palpate::bench {
namespace {

/// A plane wave of length 30 to 90 mm with values in [-1, 1].
class Wave {
public:
    explicit Wave(RandomNumbers& random) {
        const double length_mm = random.uniform(30, 90);
        k_ = 2 * 3.14159265358979323846 / length_mm * random.direction();
        phase_ = random.uniform(0, 6.28);
    }
    double operator()(const Vec3& x) const { return std::sin(k_.dot(x) + phase_); }

private:
    Vec3 k_;
    double phase_;
};

/// A quarter of the volume of a node's tets, mm^3.
std::vector<double> node_volumes(const Mesh& mesh) {
    std::vector<double> volumes(mesh.nodes.size(), 0);
    for (Index t = 0; t < mesh.num_tets(); ++t)
        for (Index n : mesh.tets[t]) volumes[n] += tet_volume(mesh, t) / 4;
    return volumes;
}

void keep_free_rows(const Model& model, Columns& columns) {
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) columns.row(d).setZero();
}

/// Gradients of the four shape functions (columns), 1/mm.
Eigen::Matrix<double, 3, 4> shape_gradients(const Mesh& mesh, const Tet& tet) {
    Mat3 edges;
    for (int c = 0; c < 3; ++c) edges.col(c) = mesh.nodes[tet[c + 1]] - mesh.nodes[tet[0]];
    Eigen::Matrix<double, 3, 4> gradients;
    gradients.rightCols<3>() = edges.inverse().transpose();
    gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
    return gradients;
}

/// f += K_t u on the columns [first, last).
///   sigma = E (lambda tr(eps) I + 2 mu eps),  f_i = volume sigma grad N_i
void add_tet_forces(const Model& model, Index t, Index first, Index last, const Columns& u,
                    Columns& f) {
    const Tet& tet = model.mesh.tets[t];
    const LinearElastic& material = model.materials[model.mesh.region[t]];
    const auto gradients = shape_gradients(model.mesh, tet);
    const double scale = tet_volume(model.mesh, t) * material.stiffness_kpa;
    for (Index c = first; c < last; ++c) {
        Eigen::Matrix<double, 3, 4> corners;
        for (int i = 0; i < 4; ++i)
            for (int a = 0; a < 3; ++a) corners(a, i) = u(3 * tet[i] + a, c);
        const Mat3 gradient = corners * gradients.transpose();
        const Mat3 stress = scale * (material.unit_lambda() * gradient.trace() * Mat3::Identity() +
                                     material.unit_mu() * (gradient + gradient.transpose()));
        const Eigen::Matrix<double, 3, 4> forces = stress * gradients;
        for (int i = 0; i < 4; ++i)
            for (int a = 0; a < 3; ++a) f(3 * tet[i] + a, c) += forces(a, i);
    }
}

}  // namespace

FreeMatrix assemble_free_matrix(const Model& model) {
    const StiffnessMatrix stiffness = assemble_stiffness(model);
    FreeMatrix matrix;
    std::vector<Index> number(model.num_dofs(), -1);
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const int count =
            model.prescribed[3 * n] + model.prescribed[3 * n + 1] + model.prescribed[3 * n + 2];
        if (count == 3) continue;
        if (count != 0)
            throw Error(ErrorCode::unsupported,
                        "Node " + std::to_string(n) +
                            " of a bench mesh has some of its components prescribed; peers need "
                            "all or none.");
        matrix.coordinates.push_back(model.mesh.nodes[n]);
        for (int a = 0; a < 3; ++a) {
            number[3 * n + a] = matrix.num_rows();
            matrix.dofs.push_back(3 * n + a);
        }
    }
    matrix.offsets.push_back(0);
    const Adjacency& graph = stiffness.graph;
    for (const Index dof : matrix.dofs) {
        for (Index k = graph.offsets[dof / 3]; k < graph.offsets[dof / 3 + 1]; ++k)
            for (Index a = 0; a < 3; ++a) {
                const Index column = number[3 * graph.items[k] + a];
                if (column < 0) continue;
                matrix.columns.push_back(column);
                matrix.values.push_back(
                    stiffness.blocks[9 * static_cast<std::size_t>(k) + 3 * (dof % 3) + a]);
            }
        matrix.offsets.push_back(static_cast<Index>(matrix.columns.size()));
    }
    return matrix;
}

Columns internal_forces(const Model& model, const Columns& u) {
    Columns f = Columns::Zero(u.rows(), u.cols());
    // Threads share the columns out, so that no two write to the same place.
    parallel_ranges(static_cast<Index>(u.cols()), 1, [&](Index first, Index last) {
        for (Index t = 0; t < model.mesh.num_tets(); ++t)
            add_tet_forces(model, t, first, last, u, f);
    });
    return f;
}

LinearProblem make_linear_problem(const BenchMesh& mesh, Index columns) {
    const Model& model = mesh.model;
    RandomNumbers random(1);
    Columns walls = Columns::Zero(model.num_dofs(), columns), body = walls;
    const std::vector<double> volumes = node_volumes(model.mesh);
    for (Index c = 0; c < columns; ++c)
        for (int a = 0; a < 3; ++a) {
            const Wave factor(random), density(random);
            for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
                const Vec3& x = model.mesh.nodes[n];
                const Index d = 3 * n + a;
                if (model.prescribed[d])
                    walls(d, c) = (c == 0 ? 1 : 1 + 0.5 * factor(x)) * mesh.prescribed_mm(d, 0);
                else
                    body(d, c) = volumes[n] * density(x);
            }
        }
    const Columns induced = free_rhs(model, walls);
    for (Index c = 0; c < columns; ++c)
        walls.col(c) += induced.col(c).norm() / body.col(c).norm() * body.col(c);
    const Columns rhs = free_rhs(model, walls);
    LinearProblem problem{std::move(walls), {}};
    for (Index c = 0; c < columns; ++c) problem.rhs_norms.push_back(rhs.col(c).norm());
    return problem;
}

Columns free_rhs(const Model& model, const Columns& b) {
    Columns prescribed = b;
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (!model.prescribed[d]) prescribed.row(d).setZero();
    Columns rhs = b - internal_forces(model, prescribed);
    keep_free_rows(model, rhs);
    return rhs;
}

double relative_residual(const Model& model, const LinearProblem& problem, const Columns& x) {
    if (x.rows() != problem.b.rows() || x.cols() != problem.b.cols())
        return std::numeric_limits<double>::infinity();
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d] && x.row(d) != problem.b.row(d))
            return std::numeric_limits<double>::infinity();
    Columns r = problem.b - internal_forces(model, x);
    keep_free_rows(model, r);
    double largest = 0;
    for (Index c = 0; c < r.cols(); ++c)
        largest = std::max(largest, r.col(c).norm() / problem.rhs_norms[c]);
    return largest;
}

}  // namespace palpate::bench
