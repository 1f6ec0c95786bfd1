// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/surface_noise.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "host/inverse/reduced_model.hpp"

namespace palpate {
namespace {

constexpr double robust_limit = 3.0;  // standard deviations

/// Twice the robust loss is the square of this.
double pulled_in(double z) {
    const double size = std::abs(z);
    if (size <= robust_limit) return z;
    return std::copysign(std::sqrt(2.0 * robust_limit * (size - 0.5 * robust_limit)), z);
}

/// Factor on sigma with which the quadratic loss has the slope of the robust one.
double inflation(double z) { return std::sqrt(std::max(1.0, std::abs(z) / robust_limit)); }

}  // namespace

SurfaceNoise::SurfaceNoise(const SurfaceObservations& observations) : observations_(&observations) {
    std::map<std::pair<Index, bool>, std::vector<Index>> by_surface;
    for (Index k = 0; k < observations.num_rows(); ++k) {
        const Observation& seen = observations.rows()[k];
        by_surface[{seen.surface, seen.on_driven}].push_back(k);
        LinearRow row;
        row.on_driven = seen.on_driven;
        row.position = seen.position;
        row.surface = seen.surface;
        row.place = seen.place;
        row.range_mm = observations.voxel_terraces().range_mm();
        rows_.push_back(row);
    }
    for (auto& [surface, rows] : by_surface) groups_.push_back({std::move(rows), {}});
    factorise();
}

void SurfaceNoise::start(const NoiseLevel& level) {
    level_ = level;
    factorise();
}

void SurfaceNoise::update(const NoiseLevel& level, const ObservedState& state) {
    level_ = level;
    const std::vector<Terraces> terraces = observations_->terraces(state);
    for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k].terraces = terraces[k];
    factorise();
}

double SurfaceNoise::contour_mm_for(double factor) const {
    double others = 0, share = 0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (rows_[k].on_driven) continue;
        const double organs = observations_->rows()[k].terrace_factor;
        others += noise_variance(rows_[k]) - rows_[k].contour_mm * rows_[k].contour_mm;
        share += organs * organs;
    }
    if (share == 0) return level_.contour_mm;
    const double b = others / share;
    return std::sqrt(std::max(0.0, factor * (level_.contour_mm * level_.contour_mm + b) - b));
}

void SurfaceNoise::factorise() {
    sigma_mm_.resize(rows_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Observation& seen = observations_->rows()[k];
        rows_[k].independent_mm = level_.scale * seen.independent_mm;
        rows_[k].contour_mm = level_.contour_mm * seen.terrace_factor;
        sigma_mm_[k] = std::sqrt(noise_variance(rows_[k]));
    }
    for (Group& group : groups_) {
        const Index n = static_cast<Index>(group.rows.size());
        Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
        for (Index j = 0; j < n; ++j) {
            const Index b = group.rows[j];
            for (Index i = j + 1; i < n; ++i) {
                const Index a = group.rows[i];
                correlation(i, j) =
                    noise_covariance(rows_[a], rows_[b]) / (sigma_mm_[a] * sigma_mm_[b]);
            }
        }
        group.correlation = cholesky(correlation, "covariance of the noise");
    }
}

double SurfaceNoise::misfit(const Eigen::VectorXd& residual_mm,
                            const std::vector<std::uint8_t>& counted) const {
    double sum = 0;
    for (const Group& group : groups_) {
        Eigen::VectorXd z(group.rows.size());
        for (std::size_t i = 0; i < group.rows.size(); ++i) {
            const Index k = group.rows[i];
            z[i] = counted[k] ? pulled_in(residual_mm[k] / sigma_mm_[k]) : 0.0;
        }
        group.correlation.matrixL().solveInPlace(z);
        sum += 0.5 * z.squaredNorm();
    }
    return sum;
}

std::vector<LinearRow> SurfaceNoise::linear_rows(const ObservedState& seen) const {
    std::vector<LinearRow> rows;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (!seen.seen[k]) continue;
        rows.push_back(rows_[k]);
        LinearRow& row = rows.back();
        row.normal = seen.normal.row(k);
        row.residual_mm = seen.residual_mm[k];
        const double factor = inflation(row.residual_mm / sigma_mm_[k]);
        row.independent_mm *= factor;
        row.terraces.waves *= factor;
        row.contour_mm *= factor;
    }
    return rows;
}

}  // namespace palpate
