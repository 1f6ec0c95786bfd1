// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/wall_posterior.hpp"

#include <utility>

#include "host/inverse/reduced_model.hpp"

namespace palpate {
namespace {

/// G x for the rows of one wall.
Eigen::MatrixXd seen_along_normals(const std::vector<LinearRow>& rows, const Eigen::MatrixXd& x) {
    Eigen::MatrixXd seen(rows.size(), x.cols());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        seen.row(i) = rows[i].normal.transpose() * x.middleRows<3>(3 * rows[i].position);
    }
    return seen;
}

}  // namespace

WallPosterior::WallPosterior(const WallPrior& prior, const std::vector<LinearRow>& rows,
                             const Eigen::VectorXd& driven)
    : prior_(prior), mean_(Eigen::VectorXd::Zero(driven.size())) {
    std::vector<Index> wall_of(prior.num_driven(), -1), place(prior.num_driven(), -1);
    for (std::size_t w = 0; w < prior.walls().size(); ++w) {
        const auto& wall = prior.walls()[w];
        for (std::size_t k = 0; k < wall.nodes.size(); ++k) {
            wall_of[wall.nodes[k]] = static_cast<Index>(w);
            place[wall.nodes[k]] = static_cast<Index>(k);
        }
        parts_.push_back({&wall, {}, {}, {}});
    }
    for (const LinearRow& row : rows) {
        if (!row.on_driven) continue;
        Rows& part = parts_[wall_of[row.position]];
        part.place.push_back(place[row.position]);
        part.rows.push_back(row);
    }
    for (Rows& part : parts_) {
        const Index n = static_cast<Index>(part.rows.size());
        Eigen::MatrixXd gram(n, n);
        Eigen::VectorXd wanted(n);
        for (Index j = 0; j < n; ++j) {
            const LinearRow& row = part.rows[j];
            for (Index i = j; i < n; ++i) {
                gram(i, j) = part.wall->covariance(part.place[i], part.place[j]) *
                                 part.rows[i].normal.dot(row.normal) +
                             (i == j ? noise_variance(row) : noise_covariance(part.rows[i], row));
            }
            wanted[j] = row.normal.dot(driven.segment<3>(3 * row.position)) - row.residual_mm;
        }
        if (n == 0) continue;
        part.gram = cholesky(gram, "covariance of the driven walls");
        mean_ += spread_back(part, part.gram.solve(wanted));
    }
}

/// S G^T w for the rows of one wall.
Eigen::VectorXd WallPosterior::spread_back(const Rows& part, const Eigen::VectorXd& weights) const {
    Eigen::MatrixXd along = Eigen::MatrixXd::Zero(part.wall->nodes.size(), 3);
    for (std::size_t i = 0; i < part.rows.size(); ++i) {
        along.row(part.place[i]) += weights[i] * part.rows[i].normal.transpose();
    }
    const Eigen::MatrixXd spread = part.wall->covariance * along;
    Eigen::VectorXd result = Eigen::VectorXd::Zero(mean_.size());
    for (std::size_t k = 0; k < part.wall->nodes.size(); ++k) {
        result.segment<3>(3 * part.wall->nodes[k]) = spread.row(k);
    }
    return result;
}

Eigen::MatrixXd WallPosterior::covariance_of(const Eigen::MatrixXd& spread,
                                             const Eigen::MatrixXd& prior_covariance) const {
    Eigen::MatrixXd covariance = prior_covariance;
    for (const Rows& part : parts_) {
        if (part.rows.empty()) continue;
        Eigen::MatrixXd seen = seen_along_normals(part.rows, spread);
        part.gram.matrixL().solveInPlace(seen);
        covariance.noalias() -= seen.transpose() * seen;
    }
    return covariance;
}

Eigen::VectorXd WallPosterior::conditioned(const Eigen::VectorXd& prior_times_v) const {
    Eigen::VectorXd result = prior_times_v;
    for (const Rows& part : parts_) {
        if (part.rows.empty()) continue;
        const Eigen::VectorXd seen = seen_along_normals(part.rows, prior_times_v);
        result -= spread_back(part, part.gram.solve(seen));
    }
    return result;
}

}  // namespace palpate
