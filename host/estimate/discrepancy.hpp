// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "host/estimate/data_problem.hpp"

namespace palpate {

/// What a model leaves unexplained in one block beside independent noise: a Gaussian field with
/// covariance s^2 K, K = k(|x - x'| / length_mm) k(|t - t'| / length_s) with k of `matern`. Rows
/// without places and times have K = I.
struct Discrepancy {
    double amplitude = 0;  ///< s, in the block's unit; 0: none
    double length_mm = 1, length_s = 1;
};

/// Matern 3/2 over a distance in lengths: (1 + q) exp(-q), q = sqrt(3) distance. Rough on purpose:
/// a smooth kernel would claim that nothing but noise is left at short lengths, and parameters
/// would rest on it (Rasmussen and Williams 2006, equation 4.17).
double matern(double distance);

/// K of a block's rows, of low rank plus a diagonal: K ~ U U^T + diag(g).
struct DiscrepancyBasis {
    Eigen::MatrixXd modes;       ///< U [num_row, rank]
    Eigen::VectorXd remainder;   ///< g [num_row], not below 0: what the modes miss of the variance
    bool is_orthogonal = false;  ///< whether U^T U is diagonal and g is the same in all rows
};

/// Which places and times a block's rows have, found once: rows of a grid (25 columns times 400
/// frames) share few of either.
class RowGrid {
public:
    explicit RowGrid(const DataBlock& block);

    Index num_row() const { return static_cast<Index>(place_of_row_.size()); }
    bool has_places() const { return positions_.cols() > 0; }
    bool has_times() const { return has_times_; }
    /// Number of different ones.
    Index num_place() const { return static_cast<Index>(positions_.rows()); }
    Index num_time() const { return static_cast<Index>(times_.size()); }
    /// Of each row, [num_row]; times count upwards.
    const Eigen::VectorXi& place_of_row() const { return place_of_row_; }
    const Eigen::VectorXi& time_of_row() const { return time_of_row_; }
    double extent_mm() const;   ///< diagonal of the box around all places
    double extent_s() const;    ///< from the first time to the last
    double spacing_mm() const;  ///< as if the places stood evenly in their box
    double spacing_s() const;   ///< as if the times were even

    /// U and g at these lengths; modes beyond `max_rank` go into g as independent noise.
    DiscrepancyBasis basis(double length_mm, double length_s, Index max_rank) const;

private:
    DiscrepancyBasis product_basis(double length_mm, double length_s, Index max_rank) const;
    DiscrepancyBasis pivoted_basis(double length_mm, double length_s, Index max_rank) const;
    double place_correlation(Index a, Index b, double length_mm) const;
    double time_correlation(Index a, Index b, double length_s) const;

    Eigen::MatrixXd positions_;  ///< [different places, dimensions]
    Eigen::VectorXd times_;      ///< [different times], ascending
    bool has_times_ = false;
    Eigen::VectorXi place_of_row_, time_of_row_;
};

}  // namespace palpate
