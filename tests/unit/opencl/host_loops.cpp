// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/opencl/host_loops.hpp"

#include <Eigen/LU>
#include <limits>
#include <random>

namespace palpate::host_loops {
namespace {

// Rows are the gradients of the four shape functions: columns of the inverse of [1, p] (4x4).
Eigen::Matrix<double, 4, 3> shape_gradients(const Mesh& mesh, Index tet) {
    Eigen::Matrix4d corners;
    for (int a = 0; a < 4; ++a) corners.row(a) << 1.0, mesh.nodes[mesh.tets[tet][a]].transpose();
    const Eigen::Matrix4d inverse = corners.inverse();
    return inverse.bottomRows<3>().transpose();
}

// The 12x12 stiffness of one element; K_ab = E V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b)
// I).
using ElementMatrix = Eigen::Matrix<double, 12, 12>;
ElementMatrix element_matrix(const Model& model, const std::vector<double>& moduli, Index tet) {
    const Index region = model.mesh.region[tet];
    const LinearElastic& law = model.materials[region];
    const Eigen::Matrix<double, 4, 3> g = shape_gradients(model.mesh, tet);
    ElementMatrix matrix;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            const Vec3 ga = g.row(a);
            const Vec3 gb = g.row(b);
            matrix.block<3, 3>(3 * a, 3 * b) = law.unit_lambda() * ga * gb.transpose() +
                                               law.unit_mu() * gb * ga.transpose() +
                                               law.unit_mu() * ga.dot(gb) * Mat3::Identity();
        }
    return moduli[region] * tet_volume(model.mesh, tet) * matrix;
}

}  // namespace

Columns internal_force(const Model& model, const std::vector<double>& moduli, const Columns& x) {
    Columns y = Columns::Zero(x.rows(), x.cols());
    for (Index t = 0; t < model.mesh.num_tets(); ++t) {
        const ElementMatrix k = element_matrix(model, moduli, t);
        for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b)
                y.middleRows<3>(3 * model.mesh.tets[t][a]) +=
                    k.block<3, 3>(3 * a, 3 * b) * x.middleRows<3>(3 * model.mesh.tets[t][b]);
    }
    return y;
}

Columns constrained_product(const Model& model, const std::vector<double>& moduli,
                            const Columns& x) {
    Columns free_x = x;
    for (Index dof = 0; dof < model.num_dofs(); ++dof)
        if (model.prescribed[dof]) free_x.row(dof).setZero();
    Columns y = internal_force(model, moduli, free_x);
    for (Index dof = 0; dof < model.num_dofs(); ++dof)
        if (model.prescribed[dof]) y.row(dof) = x.row(dof);
    return y;
}

Columns block_jacobi(const Model& model, const std::vector<double>& moduli, const Columns& r) {
    std::vector<Mat3> blocks(model.mesh.nodes.size(), Mat3::Zero());
    for (Index t = 0; t < model.mesh.num_tets(); ++t) {
        const ElementMatrix k = element_matrix(model, moduli, t);
        for (int a = 0; a < 4; ++a) blocks[model.mesh.tets[t][a]] += k.block<3, 3>(3 * a, 3 * a);
    }
    Columns z(r.rows(), r.cols());
    for (Index node = 0; node < model.mesh.num_nodes(); ++node) {
        Mat3& block = blocks[node];
        for (int i = 0; i < 3; ++i) {
            if (!model.prescribed[3 * node + i]) continue;
            block.row(i).setZero();
            block.col(i).setZero();
            block(i, i) = 1;
        }
        z.middleRows<3>(3 * node) = block.inverse() * r.middleRows<3>(3 * node);
    }
    return z;
}

std::vector<double> moduli_of(const Model& model) {
    std::vector<double> moduli;
    for (const LinearElastic& m : model.materials) moduli.push_back(m.stiffness_kpa);
    return moduli;
}

Columns random_columns(Index rows, Index columns, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Columns values(rows, columns);
    for (Index i = 0; i < rows; ++i)
        for (Index c = 0; c < columns; ++c) values(i, c) = uniform(generator);
    return values;
}

double relative_difference(const Columns& actual, const Columns& expected) {
    const Columns difference = actual - expected;
    if (!difference.allFinite()) return std::numeric_limits<double>::infinity();
    return difference.cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

}  // namespace palpate::host_loops
