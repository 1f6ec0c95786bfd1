// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// What the motion of walls is expected to be like before their distances are looked at.
struct WallExpectation {
    std::vector<Vec3> places, normals;  ///< of the driven nodes, mm; outward unit normals
    double sd_mm = 5, range_mm = 40;    ///< how far they move, and over what length together
};

/// Gaussian prior of the motion of the driven walls: u_d ~ N(0, Q^-1), before any distance is
/// looked at (WallPosterior has the precision H of both). Walls that share no node are
/// independent of each other, so the covariance is kept as one dense block per wall: with a few
/// thousand nodes on a wall this beats sparse factors, and every product is a matrix product.
///
/// Of nodes i and j of one wall it is c_ij times the identity, or, where motions along the normal
/// and along the wall are told apart,
///   c_ij (n_i n_j^T + t^2 P_i P_j) + E_i E_j^T,   P = 1 - n n^T,
/// E the six motions of the wall as a rigid body.
class WallPrior {
public:
    /// Nodes that hang together in the precision matrix.
    struct Wall {
        std::vector<Index> nodes;    ///< positions in the driven node list
        Eigen::MatrixXd covariance;  ///< c [nodes, nodes] mm^2
        /// Unit normals [nodes, 3]; empty: all directions are alike.
        Eigen::Matrix<double, Eigen::Dynamic, 3> normals = {};
        double tangential = 1;  ///< t
        /// E [3 nodes, 6] mm, of unit standard deviation each; empty as the normals.
        Eigen::Matrix<double, Eigen::Dynamic, 6> rigid = {};

        /// Between the motions of `at[k]` along the rows of `directions` [at, 3], mm^2.
        Eigen::MatrixXd covariance_along(
            const std::vector<Index>& at,
            const Eigen::Matrix<double, Eigen::Dynamic, 3>& directions) const;
        /// Q^-1 x of this wall for any number of motions, their components side by side:
        /// x [nodes, 3 motions].
        Eigen::MatrixXd times(const Eigen::MatrixXd& x) const;
    };

    /// `precision` [num_driven, num_driven] of one component, per mm^2, symmetric; the components
    /// are independent and alike. Throws Error(internal) if it is not positive definite.
    explicit WallPrior(Eigen::SparseMatrix<double> precision, WallExpectation expectation = {});
    /// The same walls with other covariances. Throws Error(solve_failed) if one is not positive
    /// definite.
    WallPrior(const WallPrior& earlier, std::vector<Wall> walls);

    Index num_driven() const { return static_cast<Index>(precision_.rows()); }
    /// That it was made from, at first.
    const Eigen::SparseMatrix<double>& precision() const { return precision_; }
    const WallExpectation& expectation() const { return expectation_; }
    const std::vector<Wall>& walls() const { return walls_; }
    /// 1/2 u^T Q u for a motion u [3 num_driven] mm.
    double energy(const Eigen::VectorXd& u) const;
    /// Q^-1 x for columns x [3 num_driven, any].
    Eigen::MatrixXd covariance_times(const Eigen::MatrixXd& x) const;
    /// `count` motions drawn from the first prior, [3 num_driven, count] mm; the same for the same
    /// seed.
    Eigen::MatrixXd samples(Index count, unsigned seed) const;

private:
    /// Of c, and of t^2 c_ij B_i^T B_j with B [3, 2] the tangents of a node; W = L^-1 E, L both
    /// together, and 1 + W^T W.
    struct Factors {
        Eigen::LLT<Eigen::MatrixXd> normal, tangential;
        std::vector<Eigen::Matrix<double, 3, 2>> tangents;
        Eigen::MatrixXd rigid;
        Eigen::LLT<Eigen::MatrixXd> inner;
    };
    static Factors factors_of(const Wall& wall);
    /// L^-1 u of one wall for columns u [3 nodes, any].
    static Eigen::MatrixXd whitened(const Wall& wall, const Factors& factors,
                                    const Eigen::MatrixXd& u);

    Eigen::SparseMatrix<double> precision_;
    WallExpectation expectation_;
    std::vector<Wall> walls_;
    std::vector<Factors> factors_;  ///< empty: of the first prior, whose precision is known
};

}  // namespace palpate
