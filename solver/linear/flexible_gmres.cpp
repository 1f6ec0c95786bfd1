// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/flexible_gmres.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

/// One round between two restarts: the least residual over x + span Z, A Z_j = sum_i V_i h_ij.
class KrylovRound {
public:
    explicit KrylovRound(int size)
        : h_(Eigen::MatrixXd::Zero(size + 1, size)),
          right_(Eigen::VectorXd::Zero(size + 1)),
          cosine_(size),
          sine_(size) {}

    void begin(const Eigen::VectorXd& residual) {
        right_[0] = residual.norm();
        v_.push_back(residual / right_[0]);
    }

    /// One more direction. False if a map fails.
    bool grow(const VectorMap& times, const VectorMap& precondition) {
        const auto j = static_cast<Eigen::Index>(z_.size());
        Eigen::VectorXd z = Eigen::VectorXd::Zero(v_[0].size()), w = z;
        // z_j = M^-1 v_j,  w = A z_j
        if (!precondition(v_.back(), z) || !times(z, w)) return false;
        for (Eigen::Index i = 0; i <= j; ++i) {
            // h_ij = w . v_i,  w -= h_ij v_i (modified Gram-Schmidt)
            h_(i, j) = w.dot(v_[i]);
            w -= h_(i, j) * v_[i];
        }
        h_(j + 1, j) = w.norm();
        z_.push_back(std::move(z));
        is_complete_ = !(h_(j + 1, j) > 0) || !w.allFinite();
        v_.push_back(is_complete_ ? w : Eigen::VectorXd(w / h_(j + 1, j)));
        rotate(j);
        return w.allFinite();
    }

    double residual() const { return std::abs(right_[static_cast<Eigen::Index>(z_.size())]); }
    bool is_complete() const { return is_complete_; }

    void add_to(Eigen::VectorXd& x) const {
        const auto count = static_cast<Eigen::Index>(z_.size());
        // R y = g,  x += Z y
        const Eigen::VectorXd y =
            h_.topLeftCorner(count, count).triangularView<Eigen::Upper>().solve(right_.head(count));
        for (Eigen::Index j = 0; j < count; ++j) x += y[j] * z_[j];
    }

private:
    /// Givens rotations make H upper triangular, column by column.
    void rotate(Eigen::Index j) {
        for (Eigen::Index i = 0; i < j; ++i) turn(i, h_(i, j), h_(i + 1, j));
        const double length = std::hypot(h_(j, j), h_(j + 1, j));
        cosine_[j] = length > 0 ? h_(j, j) / length : 1;
        sine_[j] = length > 0 ? h_(j + 1, j) / length : 0;
        turn(j, h_(j, j), h_(j + 1, j));
        turn(j, right_[j], right_[j + 1]);
    }
    void turn(Eigen::Index i, double& upper, double& lower) const {
        const double before = upper;
        upper = cosine_[i] * before + sine_[i] * lower;
        lower = cosine_[i] * lower - sine_[i] * before;
    }

    Eigen::MatrixXd h_;
    Eigen::VectorXd right_;
    std::vector<double> cosine_, sine_;
    std::vector<Eigen::VectorXd> v_, z_;
    bool is_complete_ = false;
};

}  // namespace

GmresSummary flexible_gmres(const VectorMap& times, const VectorMap& precondition,
                            const Eigen::VectorXd& b, const GmresOptions& options,
                            Eigen::VectorXd& x) {
    constexpr double too_slow = 0.9;  // of a whole round
    GmresSummary summary;
    x = Eigen::VectorXd::Zero(b.size());
    const double size = b.norm();
    if (!(size > 0)) return summary;
    Eigen::VectorXd residual = b, product = b;
    summary.relative_residual = 1;
    while (summary.relative_residual > options.relative_tolerance &&
           summary.iterations < options.max_iterations) {
        const double before = summary.relative_residual;
        KrylovRound round(options.restart);
        round.begin(residual);
        bool is_good = true;
        for (int k = 0; k < options.restart && is_good; ++k) {
            is_good = round.grow(times, precondition);
            ++summary.iterations;
            if (round.is_complete() || round.residual() <= options.relative_tolerance * size ||
                summary.iterations >= options.max_iterations)
                break;
        }
        if (!is_good) break;
        Eigen::VectorXd next = x;
        round.add_to(next);
        if (!times(next, product)) break;
        const double now = (b - product).norm() / size;
        if (!(now < before)) break;
        x = std::move(next);
        residual = b - product;
        summary.relative_residual = now;
        if (now > too_slow * before) break;
    }
    return summary;
}

}  // namespace palpate
