// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/surface_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host/apps/recover/inverse/reduced_model.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace {

constexpr double robust_limit = 3.0;  // standard deviations
/// An outlier bends what its neighbours say, so that it is looked for again without it.
constexpr int outlier_passes = 3;
/// Mean square slope of contours that are off by 1 mm with the kernel of `contour_correlation`,
/// 2 * 3 / l^2, as far as normals are smoothed of it.
constexpr double contour_slopes_per_mm2 = 0.1;

/// To what part of itself the variance of what voxels leave is known: distances of exact surfaces
/// over what was said of them are 0.8 to 1.3 where they were tried (tests/unit/inverse,
/// VoxelTerraces).
constexpr double voxels_known_to = 1.0 / 3.0;

/// Mean of N(mean, sd^2) above 0, sd > 0: mean + sd phi(z) / Phi(z), z = mean / sd. Far below 0 it
/// is sd / |z| (Mills' ratio).
double mean_above_zero(double mean, double sd) {
    const double z = mean / sd;
    if (z < -20) return -sd / z;
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    return mean + sd * density / (0.5 * std::erfc(-z / std::numbers::sqrt2));
}

double beyond_limit(double z) { return std::max(1.0, std::abs(z) / robust_limit); }

double huber_loss(double z) {
    const double size = std::abs(z);
    return size <= robust_limit ? 0.5 * z * z : robust_limit * (size - 0.5 * robust_limit);
}

/// The part of R that rows share.
Eigen::MatrixXd correlated_part(const std::vector<LinearRow>& rows) {
    Eigen::MatrixXd shared = noise_matrix(rows);
    for (std::size_t k = 0; k < rows.size(); ++k) shared(k, k) = correlated_variance(rows[k]);
    return shared;
}

}  // namespace

double CountedRows::misfit(const Eigen::VectorXd& residual_mm) const {
    double sum = 0;
    for (const Group& group : groups_) {
        Eigen::VectorXd whitened = residual_mm(group.observations);
        if (group.alone_mm.size() > 0) {
            for (const double z : whitened.cwiseQuotient(group.alone_mm)) sum += huber_loss(z);
            continue;
        }
        group.covariance.matrixL().solveInPlace(whitened);
        sum += 0.5 * whitened.squaredNorm();
    }
    return sum;
}

double CountedRows::energy(const FrameMotion& motion) const {
    if (frame_.size() == 0) return 0;
    return 0.5 * motion.dot(frame_.covariance.ldlt().solve(motion));
}

/// Slopes that the target's contours have by error, over all of those that smoothing takes away:
/// the less of them is shape, the less a wall may slide along them.
double CountedRows::roughness_to_trust(const Group& group, const ObservedState& seen) {
    double rough = 0, wrong = 0;
    for (std::size_t i = 0; i < group.rows.size(); ++i) {
        const Index k = group.observations[i];
        rough += (seen.normal.row(k) - seen.smooth_normal.row(k)).squaredNorm();
        wrong += 0.5 * std::pow(group.rows[i].contour_mm, 2) * contour_slopes_per_mm2;
    }
    return rough > 0 ? 1.0 - std::min(1.0, wrong / rough) : 0.0;
}

std::vector<LinearRow> CountedRows::linear_rows(const ObservedState& seen, bool is_smooth) const {
    std::vector<LinearRow> rows;
    for (const Group& group : groups_) {
        const double rough = is_smooth ? 0.0 : roughness_to_trust(group, seen);
        for (std::size_t i = 0; i < group.rows.size(); ++i) {
            const Index k = group.observations[i];
            const Vec3 normal = seen.normal.row(k), smooth = seen.smooth_normal.row(k);
            rows.push_back(group.rows[i]);
            rows.back().normal = smooth + rough * (normal - smooth);
            rows.back().residual_mm = seen.residual_mm[k];
        }
    }
    return rows;
}

SurfaceNoise::SurfaceNoise(const SurfaceObservations& observations) : observations_(&observations) {
    for (const Observation& seen : observations.rows()) {
        LinearRow row;
        row.on_driven = seen.on_driven;
        row.position = seen.position;
        row.surface = seen.surface;
        row.place = seen.place;
        row.range_mm = observations.voxel_terraces().range_mm();
        const std::vector<VoxelPlanes>& volumes = observations.voxel_terraces().volumes();
        for (std::size_t v = 0; v < volumes.size(); ++v)
            row.slices[v] = slice_place(volumes[v], seen.place, seen.facing);
        rows_.push_back(row);
    }
    remember_correlations(rows_);
    set_level({});
    read_frame(observations.frame_evidence());
}

void SurfaceNoise::read_frame(const FrameEvidence& evidence) {
    by_points_ = by_terraces_ = by_contours_ = FramePrior::Covariance::Zero();
    std::vector<LinearRow> rows;
    std::vector<FrameMotion> turned;
    FramePrior::Covariance normal = FramePrior::Covariance::Zero();
    for (std::size_t k = 0; k < evidence.points.size(); ++k) {
        const AlignedPoint& point = evidence.points[k];
        rows.push_back({});
        rows[k].surface = point.surface;
        rows[k].place = point.place;
        rows[k].terraces = evidence.terraces[k];
        rows[k].range_mm = observations_->voxel_terraces().range_mm();
        turned.push_back(evidence.frame.row(point.place, point.normal));
        normal += turned[k] * turned[k].transpose();
    }
    const Eigen::LLT<FramePrior::Covariance> factor(normal);
    if (rows.empty() || factor.info() != Eigen::Success) return;
    // sum_k a_k sum_l R_kl a_l^T of each part
    for (std::size_t k = 0; k < rows.size(); ++k) {
        FrameMotion terraces = rows[k].terraces.variance() * turned[k];
        FrameMotion contours = turned[k];
        for (std::size_t l = 0; l < rows.size(); ++l) {
            if (l == k || rows[l].surface != rows[k].surface) continue;
            terraces += noise_covariance(rows[k], rows[l]) * turned[l];
            contours += contour_correlation((rows[k].place - rows[l].place).norm()) * turned[l];
        }
        by_terraces_ += turned[k] * terraces.transpose();
        by_contours_ += turned[k] * contours.transpose();
    }
    by_points_ = std::pow(evidence.independent_mm, 2) * normal;
    for (FramePrior::Covariance* part : {&by_points_, &by_terraces_, &by_contours_}) {
        const FramePrior::Covariance half = factor.solve(*part);
        *part = factor.solve(half.transpose());
        *part = (0.5 * (*part + part->transpose())).eval();
    }
}

FramePrior SurfaceNoise::frame() const {
    FramePrior prior;
    prior.frame = observations_->frame_evidence().frame;
    prior.covariance = level_.scale * level_.scale * by_points_ + by_terraces_ +
                       level_.contour_mm * level_.contour_mm * by_contours_;
    return prior;
}

void SurfaceNoise::set_level(const NoiseLevel& level) {
    level_ = level;
    plain_.clear();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Observation& seen = observations_->rows()[k];
        rows_[k].independent_mm = level_.scale * seen.independent_mm;
        rows_[k].contour_mm = level_.contour_mm * seen.shared_factor;
        rows_[k].slice_share = level_.slice_share;
    }
}

void SurfaceNoise::take_terraces(const ObservedState& state) {
    plain_.clear();
    const std::vector<Terraces> terraces = observations_->terraces(state);
    for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k].terraces = terraces[k];
}

SurfaceNoise::FoundContours SurfaceNoise::contours_for(double factor) const {
    double others = 0, share = 0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (rows_[k].on_driven) continue;
        const double organs = observations_->rows()[k].shared_factor;
        others += noise_variance(rows_[k]) - contour_variance(rows_[k]);
        share += organs * organs * contour_correlation(rows_[k], rows_[k]);
    }
    if (share == 0 || others == 0) return {level_.contour_mm, 1};
    const double b = others / share;
    const double shown = factor * (level_.contour_mm * level_.contour_mm + b) - b;
    const double variance = mean_above_zero(shown, voxels_known_to * b);
    return {std::sqrt(variance), std::clamp(shown / variance, 0.0, 1.0)};
}

std::shared_ptr<const CountedRows> SurfaceNoise::count(const ObservedState& state) const {
    std::map<Surface, CountedRows::Group> by_surface;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (!state.seen[k]) continue;
        CountedRows::Group& group = by_surface[{rows_[k].surface, rows_[k].on_driven}];
        group.observations.push_back(static_cast<Index>(k));
        group.rows.push_back(rows_[k]);
    }
    auto counted = std::make_shared<CountedRows>();
    counted->frame_ = frame();
    std::vector<std::shared_ptr<const Plain>*> plains;
    for (auto& [surface, group] : by_surface) {
        plains.push_back(&plain_[surface]);
        counted->groups_.push_back(std::move(group));
    }
    const SerialBlas serial;
    parallel_ranges(static_cast<Index>(counted->groups_.size()), 1, [&](Index begin, Index end) {
        for (Index g = begin; g < end; ++g) {
            CountedRows::Group& group = counted->groups_[g];
            std::shared_ptr<const Plain>& known = *plains[g];
            if (!known || known->observations != group.observations)
                known = std::make_shared<const Plain>(plain(group));
            const Eigen::VectorXd residual = state.residual_mm(group.observations);
            group = inflated(std::move(group), *known, residual);
        }
    });
    return counted;
}

SurfaceNoise::Plain SurfaceNoise::plain(const CountedRows::Group& group) {
    Plain result{group.observations, correlated_part(group.rows), {}, {}};
    Eigen::MatrixXd covariance = result.shared;
    for (std::size_t k = 0; k < group.rows.size(); ++k)
        covariance(k, k) += std::pow(group.rows[k].independent_mm, 2);
    result.covariance = cholesky(covariance, "covariance of the noise");
    Eigen::MatrixXd root = Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols());
    result.covariance.matrixL().solveInPlace(root);
    result.precision = root.colwise().squaredNorm();
    return result;
}

CountedRows::Group SurfaceNoise::inflated(CountedRows::Group group, const Plain& plain,
                                          const Eigen::VectorXd& residual) {
    const Index n = static_cast<Index>(group.rows.size());
    Eigen::VectorXd alone(n), extra = Eigen::VectorXd::Zero(n);
    for (Index k = 0; k < n; ++k) alone[k] = std::pow(group.rows[k].independent_mm, 2);
    if (plain.shared.isZero(0)) group.alone_mm = alone.cwiseSqrt();
    Eigen::VectorXd precision = plain.precision;  // diagonal of (R + X)^-1, X = diag(extra)
    Eigen::VectorXd pull = plain.covariance.solve(residual);
    const Eigen::VectorXd plain_pull = pull;
    for (int pass = 0; pass < outlier_passes; ++pass) {
        const Eigen::VectorXd last = extra;
        std::vector<Index> outliers;
        for (Index k = 0; k < n; ++k) {
            const double own = 1.0 / precision[k] - last[k];  // given its neighbours
            const double z = pull[k] / precision[k] / std::sqrt(own);
            extra[k] = own * (beyond_limit(z) - 1.0);
            if (extra[k] > 0) outliers.push_back(k);
        }
        if (extra == last) break;
        // Woodbury: (R + X)^-1 = P - P_S (X_S^-1 + P_SS)^-1 P_S^T, P = R^-1, S the outliers
        Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(n, outliers.size());
        for (std::size_t s = 0; s < outliers.size(); ++s) columns(outliers[s], s) = 1.0;
        plain.covariance.solveInPlace(columns);
        Eigen::MatrixXd inner = columns(outliers, Eigen::all);
        for (std::size_t s = 0; s < outliers.size(); ++s) inner(s, s) += 1.0 / extra[outliers[s]];
        const Eigen::MatrixXd weights = inner.llt().solve(columns.transpose());
        precision = plain.precision - columns.cwiseProduct(weights.transpose()).rowwise().sum();
        pull = plain_pull - weights.transpose() * plain_pull(outliers);
    }
    Eigen::MatrixXd shared = plain.shared;
    const auto factorise = [&] {
        Eigen::MatrixXd covariance = shared;
        covariance.diagonal() += alone + extra;
        group.covariance = cholesky(covariance, "covariance of the noise");
    };
    if (extra.isZero(0)) {
        group.covariance = plain.covariance;
    } else {
        factorise();
    }
    const Eigen::VectorXd smooth = shared * pull;
    Eigen::VectorXd factor(n);
    for (Index k = 0; k < n; ++k) {
        const double sd = std::sqrt(shared(k, k));
        factor[k] = sd > 0 ? std::sqrt(beyond_limit(smooth[k] / sd)) : 1.0;
    }
    if ((factor.array() > 1.0).any()) {
        shared = factor.asDiagonal() * shared * factor.asDiagonal();
        factorise();
    }
    for (Index k = 0; k < n; ++k) {
        LinearRow& row = group.rows[k];
        const double before = noise_variance(row);
        row.independent_mm = std::sqrt(alone[k] + extra[k]);
        row.terraces.waves *= factor[k];
        row.contour_mm *= factor[k];
        row.weight = std::pow(before / noise_variance(row), 2);
    }
    return group;
}

}  // namespace palpate
