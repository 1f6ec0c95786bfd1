// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Gaussian prior of the motion of the driven walls: u_d ~ N(0, Q^-1), the three components
/// independent and alike. Walls that share no node are independent of each other, so the covariance
/// is kept as one dense block per wall: with a few thousand nodes on a wall this beats sparse
/// factors, and every product is a matrix product.
class WallPrior {
public:
    /// Nodes that hang together in the precision matrix.
    struct Wall {
        std::vector<Index> nodes;    ///< positions in the driven node list
        Eigen::MatrixXd covariance;  ///< [nodes, nodes] mm^2, of each component
    };

    /// `precision` [num_driven, num_driven] of one component, per mm^2, symmetric. Throws
    /// Error(internal) if it is not positive definite.
    explicit WallPrior(Eigen::SparseMatrix<double> precision);

    Index num_driven() const { return static_cast<Index>(precision_.rows()); }
    const Eigen::SparseMatrix<double>& precision() const { return precision_; }
    const std::vector<Wall>& walls() const { return walls_; }
    /// 1/2 u^T Q u for a motion u [3 num_driven] mm.
    double energy(const Eigen::VectorXd& u) const;
    /// Q^-1 x for columns x [3 num_driven, any].
    Eigen::MatrixXd covariance_times(const Eigen::MatrixXd& x) const;
    /// `count` motions drawn from the prior, [3 num_driven, count] mm; the same for the same seed.
    Eigen::MatrixXd samples(Index count, unsigned seed) const;

private:
    Eigen::SparseMatrix<double> precision_;
    std::vector<Wall> walls_;
};

}  // namespace palpate
