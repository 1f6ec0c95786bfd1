// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/wall_prior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

std::vector<std::vector<Index>> connected_nodes(const Sparse& matrix) {
    std::vector<std::vector<Index>> parts;
    std::vector<unsigned char> reached(matrix.cols(), 0);
    for (Index first = 0; first < matrix.cols(); ++first) {
        if (reached[first]) continue;
        std::vector<Index> part{first};
        reached[first] = 1;
        for (std::size_t k = 0; k < part.size(); ++k) {
            for (Sparse::InnerIterator it(matrix, part[k]); it; ++it) {
                const Index next = static_cast<Index>(it.row());
                if (!reached[next]) part.push_back(next);
                reached[next] = 1;
            }
        }
        std::sort(part.begin(), part.end());
        parts.push_back(std::move(part));
    }
    return parts;
}

Eigen::MatrixXd covariance_of(const Sparse& precision, const std::vector<Index>& nodes,
                              const std::vector<Index>& place) {
    const Index n = static_cast<Index>(nodes.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (Index k = 0; k < n; ++k) {
        for (Sparse::InnerIterator it(precision, nodes[k]); it; ++it) {
            entries.emplace_back(place[it.row()], k, it.value());
        }
    }
    Sparse block(n, n);
    block.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Sparse> factor(block);
    if (factor.info() != Eigen::Success || (factor.vectorD().array() <= 0).any()) {
        throw Error(ErrorCode::internal, "the prior of the driven displacement is not definite");
    }
    const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));
    return 0.5 * (inverse + inverse.transpose());
}

/// The rows of one wall, its components side by side: [nodes, 3 columns].
Eigen::MatrixXd gather(const Eigen::MatrixXd& x, const std::vector<Index>& nodes) {
    Eigen::MatrixXd part(nodes.size(), 3 * x.cols());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        for (int c = 0; c < 3; ++c) {
            part.row(k).segment(c * x.cols(), x.cols()) = x.row(3 * nodes[k] + c);
        }
    }
    return part;
}

void scatter(const Eigen::MatrixXd& part, const std::vector<Index>& nodes, Eigen::MatrixXd& x) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        for (int c = 0; c < 3; ++c) {
            x.row(3 * nodes[k] + c) = part.row(k).segment(c * x.cols(), x.cols());
        }
    }
}

/// Normally distributed numbers that are the same with every standard library (Box and Muller).
Eigen::MatrixXd normal_numbers(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
    std::mt19937_64 engine(seed);
    const auto uniform = [&] { return (double(engine() >> 11) + 0.5) * 0x1.0p-53; };
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] {
        const double radius = std::sqrt(-2.0 * std::log(uniform()));
        return radius * std::cos(2.0 * std::numbers::pi * uniform());
    });
}

}  // namespace

WallPrior::WallPrior(Sparse precision) : precision_(std::move(precision)) {
    std::vector<Index> place(precision_.cols());
    for (auto& nodes : connected_nodes(precision_)) {
        for (std::size_t k = 0; k < nodes.size(); ++k) place[nodes[k]] = static_cast<Index>(k);
        Eigen::MatrixXd covariance = covariance_of(precision_, nodes, place);
        walls_.push_back({std::move(nodes), std::move(covariance)});
    }
}

double WallPrior::energy(const Eigen::VectorXd& u) const {
    double sum = 0;
    for (Index column = 0; column < precision_.outerSize(); ++column) {
        const Vec3 here = u.segment<3>(3 * column);
        for (Sparse::InnerIterator it(precision_, column); it; ++it) {
            sum += it.value() * here.dot(u.segment<3>(3 * it.row()));
        }
    }
    return 0.5 * sum;
}

Eigen::MatrixXd WallPrior::covariance_times(const Eigen::MatrixXd& x) const {
    Eigen::MatrixXd result(x.rows(), x.cols());
    for (const Wall& wall : walls_) {
        scatter(wall.covariance * gather(x, wall.nodes), wall.nodes, result);
    }
    return result;
}

Eigen::MatrixXd WallPrior::samples(Index count, unsigned seed) const {
    Eigen::MatrixXd result(3 * num_driven(), count);
    for (const Wall& wall : walls_) {
        const Eigen::LLT<Eigen::MatrixXd> factor(wall.covariance);
        const Eigen::MatrixXd numbers =
            normal_numbers(static_cast<Eigen::Index>(wall.nodes.size()), 3 * count, seed++);
        scatter(factor.matrixL() * numbers, wall.nodes, result);
    }
    return result;
}

}  // namespace palpate
