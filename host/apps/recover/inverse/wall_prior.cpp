// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/wall_prior.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "host/apps/recover/inverse/reduced_model.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"

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
    // C = Q^-1, Q the sparse precision of one wall
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
        // sqrt(-2 ln a) cos(2 pi b), a and b uniform on (0, 1)
        const double radius = std::sqrt(-2.0 * std::log(uniform()));
        return radius * std::cos(2.0 * std::numbers::pi * uniform());
    });
}

}  // namespace

Eigen::MatrixXd WallPrior::Wall::covariance_along(
    const std::vector<Index>& at,
    const Eigen::Matrix<double, Eigen::Dynamic, 3>& directions) const {
    const Eigen::MatrixXd together = covariance(at, at);
    if (normals.rows() == 0) return together.cwiseProduct(directions * directions.transpose());
    const Eigen::Matrix<double, Eigen::Dynamic, 3> at_normals = normals(at, Eigen::all);
    const Eigen::VectorXd along = at_normals.cwiseProduct(directions).rowwise().sum();
    const Eigen::MatrixXd across =
        tangential * (directions - at_normals.cwiseProduct(along.replicate<1, 3>()));
    Eigen::MatrixXd as_body(at.size(), 6);
    for (std::size_t k = 0; k < at.size(); ++k)
        as_body.row(k) = directions.row(k) * rigid.middleRows<3>(3 * at[k]);
    // k s^2 ((g.n)(g'.n') + t^2 (P g).(P' g')) + (g E)(g' E)^T (method.md, 3.1)
    return together.cwiseProduct(along * along.transpose() + across * across.transpose()) +
           as_body * as_body.transpose();
}

Eigen::MatrixXd WallPrior::Wall::times(const Eigen::MatrixXd& x) const {
    if (normals.rows() == 0) return covariance * x;
    const Index motions = static_cast<Index>(x.cols()) / 3;
    const auto component = [&](const Eigen::MatrixXd& of, int c) {
        return of.middleCols(c * motions, motions);
    };
    // The motion along the normals, N^T x, and what is left of it, P x.
    const auto along_normals = [&](const Eigen::MatrixXd& of) {
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(of.rows(), motions);
        for (int c = 0; c < 3; ++c) sum += normals.col(c).asDiagonal() * component(of, c);
        return sum;
    };
    const auto add_along = [&](const Eigen::MatrixXd& along, Eigen::MatrixXd& to) {
        for (int c = 0; c < 3; ++c)
            to.middleCols(c * motions, motions) += normals.col(c).asDiagonal() * along;
    };
    const Eigen::MatrixXd along = along_normals(x);
    Eigen::MatrixXd across = x;
    add_along(-along, across);
    // C x = N K N^T x + t^2 P K P x + E E^T x
    Eigen::MatrixXd result = tangential * tangential * (covariance * across);
    add_along(covariance * along - along_normals(result), result);
    Eigen::MatrixXd as_body = Eigen::MatrixXd::Zero(6, motions);
    std::array<Eigen::MatrixXd, 3> bodies;  // E of each component
    for (int c = 0; c < 3; ++c) {
        bodies[c] = rigid(Eigen::seqN(c, x.rows(), 3), Eigen::all);
        as_body += bodies[c].transpose() * component(x, c);
    }
    for (int c = 0; c < 3; ++c) result.middleCols(c * motions, motions) += bodies[c] * as_body;
    return result;
}

WallPrior::WallPrior(Sparse precision, WallExpectation expectation)
    : precision_(std::move(precision)), expectation_(std::move(expectation)) {
    std::vector<Index> place(precision_.cols());
    for (auto& nodes : connected_nodes(precision_)) {
        for (std::size_t k = 0; k < nodes.size(); ++k) place[nodes[k]] = static_cast<Index>(k);
        Eigen::MatrixXd covariance = covariance_of(precision_, nodes, place);
        walls_.push_back({std::move(nodes), std::move(covariance)});
    }
}

WallPrior::WallPrior(const WallPrior& earlier, std::vector<Wall> walls)
    : precision_(earlier.precision_),
      expectation_(earlier.expectation_),
      walls_(std::move(walls)),
      factors_(walls_.size()) {
    const SerialBlas serial;
    parallel_ranges(static_cast<Index>(walls_.size()), 1, [&](Index begin, Index end) {
        for (Index w = begin; w < end; ++w) factors_[w] = factors_of(walls_[w]);
    });
}

WallPrior::Factors WallPrior::factors_of(const Wall& wall) {
    const Index n = static_cast<Index>(wall.nodes.size());
    Factors factors;
    factors.normal = cholesky(wall.covariance, "covariance of the walls");
    for (Index k = 0; k < n; ++k) {
        const Vec3 normal = wall.normals.row(k);
        factors.tangents.emplace_back();
        factors.tangents[k].col(0) = normal.unitOrthogonal();
        factors.tangents[k].col(1) = normal.cross(factors.tangents[k].col(0));
    }
    Eigen::MatrixXd along(2 * n, 2 * n);
    for (Index j = 0; j < n; ++j) {
        for (Index i = j; i < n; ++i)
            // t^2 K_ij T_i^T T_j in two tangents T of each node
            along.block<2, 2>(2 * i, 2 * j) = wall.tangential * wall.tangential *
                                              wall.covariance(i, j) *
                                              factors.tangents[i].transpose() * factors.tangents[j];
    }
    factors.tangential = cholesky(along, "covariance of the walls");
    factors.rigid = whitened(wall, factors, wall.rigid);
    // 1 + E^T C_0^-1 E, C_0 without the motion as a body (Woodbury)
    factors.inner.compute(Eigen::MatrixXd::Identity(6, 6) +
                          factors.rigid.transpose() * factors.rigid);
    return factors;
}

Eigen::MatrixXd WallPrior::whitened(const Wall& wall, const Factors& factors,
                                    const Eigen::MatrixXd& u) {
    const Index n = static_cast<Index>(wall.nodes.size());
    Eigen::MatrixXd out(n, u.cols()), along(2 * n, u.cols()), all(3 * n, u.cols());
    for (Index k = 0; k < n; ++k) {
        out.row(k) = wall.normals.row(k) * u.middleRows<3>(3 * k);
        along.middleRows<2>(2 * k) = factors.tangents[k].transpose() * u.middleRows<3>(3 * k);
    }
    factors.normal.matrixL().solveInPlace(out);
    factors.tangential.matrixL().solveInPlace(along);
    all << out, along;
    return all;
}

double WallPrior::energy(const Eigen::VectorXd& u) const {
    double sum = 0;
    for (std::size_t w = 0; w < factors_.size(); ++w) {
        Eigen::VectorXd moved(3 * walls_[w].nodes.size());
        for (std::size_t k = 0; k < walls_[w].nodes.size(); ++k)
            moved.segment<3>(3 * k) = u.segment<3>(3 * walls_[w].nodes[k]);
        const Eigen::VectorXd white = whitened(walls_[w], factors_[w], moved);
        const Eigen::VectorXd as_body = factors_[w].rigid.transpose() * white;
        // u^T C^-1 u = |L^-1 u|^2 - (E^T C_0^-1 u)^T (1 + E^T C_0^-1 E)^-1 (..)
        sum += white.squaredNorm() - as_body.dot(factors_[w].inner.solve(as_body));
    }
    if (!factors_.empty()) return 0.5 * sum;
    for (Index column = 0; column < precision_.outerSize(); ++column) {
        const Vec3 here = u.segment<3>(3 * column);
        for (Sparse::InnerIterator it(precision_, column); it; ++it) {
            // 1/2 u^T Q u
            sum += it.value() * here.dot(u.segment<3>(3 * it.row()));
        }
    }
    return 0.5 * sum;
}

Eigen::MatrixXd WallPrior::covariance_times(const Eigen::MatrixXd& x) const {
    Eigen::MatrixXd result(x.rows(), x.cols());
    for (const Wall& wall : walls_) scatter(wall.times(gather(x, wall.nodes)), wall.nodes, result);
    return result;
}

Eigen::MatrixXd WallPrior::samples(Index count, unsigned seed) const {
    Eigen::MatrixXd result(3 * num_driven(), count);
    for (const Wall& wall : walls_) {
        const Eigen::LLT<Eigen::MatrixXd> factor(wall.covariance);
        const Eigen::MatrixXd numbers =
            normal_numbers(static_cast<Eigen::Index>(wall.nodes.size()), 3 * count, seed++);
        // L x, x ~ N(0, 1), L L^T = C
        scatter(factor.matrixL() * numbers, wall.nodes, result);
    }
    return result;
}

}  // namespace palpate
