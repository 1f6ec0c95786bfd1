// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/wall_posterior.hpp"

#include <utility>

#include "host/apps/recover/inverse/reduced_model.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"

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
                             const Eigen::VectorXd& driven, const FramePrior& frame)
    : prior_(prior), mean_(Eigen::VectorXd::Zero(driven.size())) {
    std::vector<Index> wall_of(prior.num_driven(), -1), place(prior.num_driven(), -1);
    for (std::size_t w = 0; w < prior.walls().size(); ++w) {
        const auto& wall = prior.walls()[w];
        for (std::size_t k = 0; k < wall.nodes.size(); ++k) {
            wall_of[wall.nodes[k]] = static_cast<Index>(w);
            place[wall.nodes[k]] = static_cast<Index>(k);
        }
        parts_.emplace_back().wall = &wall;
    }
    for (const LinearRow& row : rows) {
        if (!row.on_driven) continue;
        Rows& part = parts_[wall_of[row.position]];
        part.place.push_back(place[row.position]);
        part.rows.push_back(row);
    }
    const SerialBlas serial;
    parallel_ranges(static_cast<Index>(parts_.size()), 1, [&](Index begin, Index end) {
        for (Index p = begin; p < end; ++p) condition(parts_[p], driven, frame);
    });
    frame_root_.resize(frame.size(), frame.size());
    frame_spread_.setZero(driven.size(), frame.size());
    if (frame.size() > 0) find_frame(frame);
}

void WallPosterior::find_frame(const FramePrior& frame) {
    FramePrior::Covariance precision = frame.covariance.inverse();
    FrameMotion pull = FrameMotion::Zero();
    for (const Rows& part : parts_) {
        Eigen::MatrixXd turned(part.rows.size(), 6);  // A
        for (std::size_t i = 0; i < part.rows.size(); ++i)
            turned.row(i) = frame.frame.row(part.rows[i].place, part.rows[i].normal);
        if (part.rows.empty()) continue;
        // M = S^-1 + A^T K^-1 A, delta = M^-1 A^T K^-1 y, A the rows' motion with the frame
        const Eigen::MatrixXd weights = part.gram.solve(turned);
        precision += turned.transpose() * weights;
        pull += weights.transpose() * part.wanted;
        add_spread_back(part, weights, 1.0, frame_spread_);
    }
    const Eigen::LLT<FramePrior::Covariance> factor(precision);  // M = U^T U, L = U^-1
    frame_mean_ = factor.solve(pull);
    frame_root_ = factor.matrixU().solve(Eigen::MatrixXd::Identity(6, 6));
    mean_ -= frame_spread_ * frame_mean_;
}

/// Factorises K of one wall and writes its nodes' part of S G^T K^-1 y.
void WallPosterior::condition(Rows& part, const Eigen::VectorXd& driven, const FramePrior& frame) {
    const Index n = static_cast<Index>(part.rows.size());
    if (n == 0) return;
    Eigen::Matrix<double, Eigen::Dynamic, 3> normals(n, 3);
    for (Index j = 0; j < n; ++j) normals.row(j) = part.rows[j].normal;
    const Eigen::MatrixXd gram =
        part.wall->covariance_along(part.place, normals) + noise_matrix(part.rows);
    Eigen::VectorXd& wanted = part.wanted;
    wanted.resize(n);
    for (Index j = 0; j < n; ++j) {
        const LinearRow& row = part.rows[j];
        // K = G C G^T + R, y_j = n . u_d + (the frame's part) - r_j, m = C G^T K^-1 y
        wanted[j] = row.normal.dot(driven.segment<3>(3 * row.position)) +
                    frame.frame.row(row.place, row.normal).dot(frame.motion) - row.residual_mm;
    }
    part.gram = cholesky(gram, "covariance of the driven walls");
    add_spread_back(part, part.gram.solve(wanted), 1.0, mean_);
}

/// result += scale S G^T W for the rows of one wall; touches its nodes only.
void WallPosterior::add_spread_back(const Rows& part, const Eigen::MatrixXd& weights, double scale,
                                    Eigen::Ref<Eigen::MatrixXd> result) const {
    const Eigen::Index count = weights.cols();
    // The components side by side, as `times` takes them.
    Eigen::MatrixXd along = Eigen::MatrixXd::Zero(part.wall->nodes.size(), 3 * count);
    for (std::size_t i = 0; i < part.rows.size(); ++i)
        for (int c = 0; c < 3; ++c)
            along.row(part.place[i]).segment(c * count, count) +=
                part.rows[i].normal[c] * weights.row(i);
    const Eigen::MatrixXd spread = scale * part.wall->times(along);
    for (std::size_t k = 0; k < part.wall->nodes.size(); ++k)
        for (int c = 0; c < 3; ++c)
            result.row(3 * part.wall->nodes[k] + c) += spread.row(k).segment(c * count, count);
}

Eigen::MatrixXd WallPosterior::covariance_of(const Eigen::MatrixXd& spread,
                                             const Eigen::MatrixXd& prior_covariance) const {
    std::vector<Eigen::MatrixXd> known(parts_.size());
    const SerialBlas serial;
    parallel_ranges(static_cast<Index>(parts_.size()), 1, [&](Index begin, Index end) {
        for (Index p = begin; p < end; ++p) {
            const Rows& part = parts_[p];
            known[p].setZero(spread.cols(), spread.cols());
            if (part.rows.empty() || spread.cols() == 0) continue;  // BLAS takes no empty matrices
            Eigen::MatrixXd seen = seen_along_normals(part.rows, spread);
            part.gram.matrixL().solveInPlace(seen);
            // N (C - C G^T K^-1 G C) N^T: |L^-1 G C N^T|^2 is taken off, K = L L^T
            known[p].selfadjointView<Eigen::Lower>().rankUpdate(seen.transpose());
        }
    });
    Eigen::MatrixXd covariance = prior_covariance;
    for (const auto& part : known) {
        covariance -= Eigen::MatrixXd(part.selfadjointView<Eigen::Lower>());
    }
    return covariance;
}

Eigen::VectorXd WallPosterior::conditioned(const Eigen::VectorXd& prior_times_v) const {
    Eigen::VectorXd result = prior_times_v;
    for (const Rows& part : parts_) {
        if (part.rows.empty()) continue;
        const Eigen::VectorXd seen = seen_along_normals(part.rows, prior_times_v);
        // H^-1 v = C v - C G^T K^-1 G C v
        add_spread_back(part, part.gram.solve(seen), -1.0, result);
    }
    return result;
}

}  // namespace palpate
