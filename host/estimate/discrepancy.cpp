// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/discrepancy.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

namespace palpate {
namespace {

/// Modes end where they have all but this share of the variance.
constexpr double left_out_share = 1e-4;
/// Modes along one axis, places or times, before they are multiplied.
constexpr Index max_axis_rank = 160;
/// Fewer rows are as fast without orthogonal modes.
constexpr Index least_orthogonal_rows = 1000;

/// R [count, rank] with R R^T ~ K, by Cholesky factorisation with diagonal pivoting (Harbrecht,
/// Peters and Schneider 2012): each pivot is the row that the modes so far know least of.
template <typename Kernel>
Eigen::MatrixXd pivoted_factor(Index count, Index max_rank, const Kernel& kernel) {
    max_rank = std::min(count, max_rank);
    Eigen::MatrixXd root(count, max_rank);
    Eigen::VectorXd left = Eigen::VectorXd::Ones(count);
    Index rank = 0;
    while (rank < max_rank && left.sum() > left_out_share * static_cast<double>(count)) {
        Index pivot = 0;
        const double largest = left.maxCoeff(&pivot);
        if (!(largest > 1e-12)) break;
        auto column = root.col(rank);
        for (Index i = 0; i < count; ++i) column[i] = kernel(i, pivot);
        // r_k = (K[:, p] - R R[p, :]^T) / sqrt(d_p),  d -= r_k^2
        column.noalias() -= root.leftCols(rank) * root.row(pivot).head(rank).transpose();
        column /= std::sqrt(largest);
        left = (left - column.cwiseAbs2()).cwiseMax(0.0);
        left[pivot] = 0;
        ++rank;
    }
    return root.leftCols(rank);
}

/// The same product R R^T with orthogonal columns, longest first.
Eigen::MatrixXd with_orthogonal_columns(const Eigen::MatrixXd& root) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(root.transpose() * root);
    return root * eigen.eigenvectors().rowwise().reverse();
}

/// Which pairs of columns of two factors have the longest products, until all but a negligible
/// share of `total` is in them.
std::vector<std::array<Index, 2>> longest_pairs(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                                                double total, Index max_count) {
    std::vector<std::array<Index, 2>> pairs;
    for (Index i = 0; i < a.size(); ++i)
        for (Index j = 0; j < b.size(); ++j) pairs.push_back({i, j});
    const auto length = [&](const std::array<Index, 2>& pair) { return a[pair[0]] * b[pair[1]]; };
    std::stable_sort(pairs.begin(), pairs.end(),
                     [&](const auto& p, const auto& q) { return length(p) > length(q); });
    double left = total;
    std::size_t count = 0;
    while (count < pairs.size() && static_cast<Index>(count) < max_count &&
           left > left_out_share * total)
        left -= length(pairs[count++]);
    pairs.resize(count);
    return pairs;
}

}  // namespace

double matern(double distance) {
    // (1 + q) exp(-q), q = sqrt(3) d
    const double q = std::numbers::sqrt3 * distance;
    return (1.0 + q) * std::exp(-q);
}

RowGrid::RowGrid(const DataBlock& block)
    : has_times_(block.time_s.size() > 0),
      place_of_row_(Eigen::VectorXi::Zero(block.num_row())),
      time_of_row_(Eigen::VectorXi::Zero(block.num_row())) {
    std::map<std::array<double, 3>, int> places;
    std::vector<std::array<double, 3>> found;
    std::vector<double> times(block.time_s.begin(), block.time_s.end());
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    for (Index i = 0; i < block.num_row(); ++i) {
        std::array<double, 3> place{};
        for (Index d = 0; d < block.position_mm.cols(); ++d) place[d] = block.position_mm(i, d);
        const auto [entry, is_new] = places.try_emplace(place, static_cast<int>(found.size()));
        if (is_new) found.push_back(place);
        place_of_row_[i] = entry->second;
        if (has_times_)
            time_of_row_[i] = static_cast<int>(
                std::lower_bound(times.begin(), times.end(), block.time_s[i]) - times.begin());
    }
    positions_.resize(static_cast<Index>(found.size()), block.position_mm.cols());
    for (Index p = 0; p < positions_.rows(); ++p)
        for (Index d = 0; d < positions_.cols(); ++d) positions_(p, d) = found[p][d];
    times_ = Eigen::Map<const Eigen::VectorXd>(times.data(), static_cast<Index>(times.size()));
    if (!has_times_) times_ = Eigen::VectorXd::Zero(1);
}

double RowGrid::extent_mm() const {
    if (positions_.size() == 0) return 0;
    return (positions_.colwise().maxCoeff() - positions_.colwise().minCoeff()).norm();
}

double RowGrid::extent_s() const {
    return has_times_ ? times_[times_.size() - 1] - times_[0] : 0.0;
}

double RowGrid::spacing_mm() const {
    if (!has_places() || num_place() < 2) return extent_mm();
    const double along =
        std::pow(static_cast<double>(num_place()), 1.0 / static_cast<double>(positions_.cols()));
    return extent_mm() / std::max(1.0, along - 1.0);
}

double RowGrid::spacing_s() const {
    return extent_s() / std::max(1.0, static_cast<double>(num_time()) - 1.0);
}

double RowGrid::place_correlation(Index a, Index b, double length_mm) const {
    if (!has_places()) return 1.0;
    return matern((positions_.row(a) - positions_.row(b)).norm() / length_mm);
}

double RowGrid::time_correlation(Index a, Index b, double length_s) const {
    return has_times_ ? matern(std::abs(times_[a] - times_[b]) / length_s) : 1.0;
}

DiscrepancyBasis RowGrid::basis(double length_mm, double length_s, Index max_rank) const {
    if (!has_places() && !has_times())
        return {Eigen::MatrixXd(num_row(), 0), Eigen::VectorXd::Ones(num_row()), false};
    const bool is_product = num_place() * num_time() <= 4 * num_row();
    return is_product ? product_basis(length_mm, length_s, max_rank)
                      : pivoted_basis(length_mm, length_s, max_rank);
}

/// Rows on a grid, some of which may be missing: K = K_x (x) K_t at the places and times there are,
/// so that modes are products of a mode of the places and one of the times. Both are few.
DiscrepancyBasis RowGrid::product_basis(double length_mm, double length_s, Index max_rank) const {
    Eigen::MatrixXd of_places = pivoted_factor(num_place(), max_axis_rank, [&](Index a, Index b) {
        return place_correlation(a, b, length_mm);
    });
    Eigen::MatrixXd of_times = pivoted_factor(num_time(), max_axis_rank, [&](Index a, Index b) {
        return time_correlation(a, b, length_s);
    });
    const bool is_full = num_row() == num_place() * num_time();
    const bool is_orthogonal = is_full && num_row() >= least_orthogonal_rows;
    if (is_orthogonal) {
        of_places = with_orthogonal_columns(of_places);
        of_times = with_orthogonal_columns(of_times);
    }
    const auto pairs =
        longest_pairs(of_places.colwise().squaredNorm(), of_times.colwise().squaredNorm(),
                      static_cast<double>(num_place() * num_time()), max_rank);
    DiscrepancyBasis basis;
    basis.modes.resize(num_row(), static_cast<Index>(pairs.size()));
    for (std::size_t k = 0; k < pairs.size(); ++k)
        for (Index i = 0; i < num_row(); ++i)
            basis.modes(i, k) =
                of_places(place_of_row_[i], pairs[k][0]) * of_times(time_of_row_[i], pairs[k][1]);
    basis.remainder = (1.0 - basis.modes.rowwise().squaredNorm().array()).cwiseMax(0.0);
    basis.is_orthogonal = is_orthogonal;
    if (is_orthogonal) basis.remainder.setConstant(basis.remainder.mean());
    return basis;
}

/// Scattered rows: the rows that are pivots stand for all (inducing points).
DiscrepancyBasis RowGrid::pivoted_basis(double length_mm, double length_s, Index max_rank) const {
    DiscrepancyBasis basis;
    basis.modes = pivoted_factor(num_row(), max_rank, [&](Index a, Index b) {
        return place_correlation(place_of_row_[a], place_of_row_[b], length_mm) *
               time_correlation(time_of_row_[a], time_of_row_[b], length_s);
    });
    basis.remainder = (1.0 - basis.modes.rowwise().squaredNorm().array()).cwiseMax(0.0);
    return basis;
}

}  // namespace palpate
