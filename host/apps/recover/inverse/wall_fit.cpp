// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/wall_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host/estimate/trust_region.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_rows = 250;  ///< of one wall
constexpr int most_trials = 80;
constexpr double first_step = 0.7, tolerance = 0.02;  // of what the search sees
// What is expected of motions before the settings are read: medians, and the spread of logarithms.
constexpr double normal_median_mm = 4.0, range_median_mm = 30.0, tangential_median = 0.3;
constexpr double normal_spread = 0.79, range_spread = 0.59,
                 tangential_spread = 0.79;  // ln 2.2, 1.8
// The same as the settings say it, where the fit starts.
constexpr double normal_of_sd = 0.8, range_of_range = 0.75;
constexpr double rigid_of_sd = 0.6, least_rigid_mm = 3.0;
constexpr double slide_mm = 1.5;  // along a wall, however little its normals show
constexpr double farthest = 3.0;  // from the medians, in these
constexpr double least_range_mm = 10.0;
constexpr double nugget = 1e-6;  // of the variance, so that long ranges can be factorised

/// Standard deviation of a wall's motion as a body. Its distances know such motions to a tenth of a
/// millimetre, so that it matters only that it is not too small.
double rigid_of(const WallExpectation& expected) {
    return std::max(least_rigid_mm, rigid_of_sd * expected.sd_mm);
}

/// Motion along a wall over that along its normals. Distances hardly see a wall slide along itself,
/// so that they cannot exclude it.
double tangential_of(const WallMotionScale::Wall& wall, double fitted) {
    // t^2 s^2 + (1.5 mm)^2 as a multiple of s^2 (method.md, 3.1)
    return std::hypot(fitted, slide_mm / wall.normal_mm);
}

double matern32(double distance, double range) {
    const double q = std::numbers::sqrt3 * distance / range;
    return (1.0 + q) * std::exp(-q);
}

/// Of a wall about the middle of its nodes: shifts, and turns that move its nodes as far.
Eigen::Matrix<double, Eigen::Dynamic, 6> rigid_motions(const std::vector<Vec3>& places,
                                                       double rigid_mm) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& place : places) middle += place / double(places.size());
    double squares = 0;
    for (const Vec3& place : places) squares += (place - middle).squaredNorm();
    // A turn of 1 / radius, radius the root mean square distance, moves nodes by 1 mm.
    const double radius = std::sqrt(std::max(1e-12, squares / double(places.size())));
    Eigen::Matrix<double, Eigen::Dynamic, 6> motions(3 * places.size(), 6);
    for (std::size_t k = 0; k < places.size(); ++k) {
        motions.middleRows<3>(3 * k).leftCols<3>() = rigid_mm * Mat3::Identity();
        for (int axis = 0; axis < 3; ++axis)
            motions.block<3, 1>(3 * k, 3 + axis) =
                rigid_mm / radius * Vec3::Unit(axis).cross(places[k] - middle);
    }
    return motions;
}

std::vector<Vec3> places_of(const WallPrior& prior, std::size_t wall) {
    std::vector<Vec3> places;
    for (const Index node : prior.walls()[wall].nodes)
        places.push_back(prior.expectation().places[node]);
    return places;
}

/// The distances of one wall.
struct Distances {
    std::vector<LinearRow> rows;
    std::vector<Vec3> normals;        ///< of the wall at each row
    Eigen::VectorXd along;            ///< the row's normal along the wall's
    Eigen::MatrixXd noise, apart_mm;  ///< noise: with the wall's motion as a body
    Eigen::VectorXd wanted;
};

std::vector<Distances> distances_of(const WallPrior& prior, const std::vector<LinearRow>& rows,
                                    const Eigen::VectorXd& driven, const FramePrior& frame) {
    const WallExpectation& expected = prior.expectation();
    std::vector<Index> wall_of(prior.num_driven(), -1), place_of(prior.num_driven(), -1);
    for (std::size_t w = 0; w < prior.walls().size(); ++w) {
        const std::vector<Index>& nodes = prior.walls()[w].nodes;
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            wall_of[nodes[k]] = static_cast<Index>(w);
            place_of[nodes[k]] = static_cast<Index>(k);
        }
    }
    std::vector<std::vector<LinearRow>> all(prior.walls().size());
    for (const LinearRow& row : rows)
        if (row.on_driven) all[wall_of[row.position]].push_back(row);
    std::vector<Distances> walls(all.size());
    for (std::size_t w = 0; w < all.size(); ++w) {
        const std::size_t step = (all[w].size() + most_rows - 1) / most_rows;
        for (std::size_t k = 0; k < all[w].size(); k += step) walls[w].rows.push_back(all[w][k]);
        Distances& wall = walls[w];
        const Index n = static_cast<Index>(wall.rows.size());
        wall.along.resize(n);
        wall.wanted.resize(n);
        wall.noise = noise_matrix(wall.rows);
        wall.apart_mm.resize(n, n);
        for (Index j = 0; j < n; ++j) {
            const LinearRow& row = wall.rows[j];
            wall.normals.push_back(expected.normals[row.position]);
            wall.along[j] = row.normal.dot(wall.normals[j]);
            // y_j = n . u_d + (the frame's part) - r_j, as of the observed surfaces
            wall.wanted[j] = row.normal.dot(driven.segment<3>(3 * row.position)) +
                             frame.frame.row(row.place, row.normal).dot(frame.motion) -
                             row.residual_mm;
            for (Index i = j; i < n; ++i)
                wall.apart_mm(i, j) = (wall.rows[i].place - row.place).norm();
        }
        if (n == 0) continue;
        const auto motions = rigid_motions(places_of(prior, w), rigid_of(prior.expectation()));
        Eigen::MatrixXd seen(n, 6);
        for (Index j = 0; j < n; ++j)
            seen.row(j) = wall.rows[j].normal.transpose() *
                          motions.middleRows<3>(3 * place_of[wall.rows[j].position]);
        // R + G E E^T G^T: the motion as a body does not depend on what is searched for (3.1).
        wall.noise += seen * seen.transpose();
    }
    return walls;
}

/// -L of one wall.
double cost_of(const Distances& wall, const WallMotionScale::Wall& scale, double tangential) {
    const Index n = static_cast<Index>(wall.rows.size());
    if (n == 0) return 0;
    Eigen::MatrixXd covariance = wall.noise;
    const double variance = scale.normal_mm * scale.normal_mm;
    for (Index j = 0; j < n; ++j) {
        const Vec3 across_j = wall.rows[j].normal - wall.along[j] * wall.normals[j];
        for (Index i = j; i < n; ++i) {
            const Vec3 across_i = wall.rows[i].normal - wall.along[i] * wall.normals[i];
            covariance(i, j) +=
                // k(d) (s^2 (g.n)(g'.n') + t^2 s^2 (P g).(P' g')), g the rows' normals (method.md,
                // 3.1)
                variance * matern32(wall.apart_mm(i, j), scale.range_mm) *
                (wall.along[i] * wall.along[j] + tangential * tangential * across_i.dot(across_j));
        }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
    Eigen::VectorXd whitened = wall.wanted;
    factor.matrixL().solveInPlace(whitened);
    // 1/2 y^T C^-1 y + 1/2 ln det C = 1/2 |L^-1 y|^2 + sum ln L_ii (method.md, 3.2)
    return 0.5 * whitened.squaredNorm() +
           Eigen::VectorXd(factor.matrixLLT().diagonal()).array().log().sum();
}

/// What the search sees: logarithms over their medians, in spreads; ranges, then normal parts, then
/// the tangential one.
class Evidence {
public:
    Evidence(const WallPrior& prior, const std::vector<LinearRow>& rows,
             const Eigen::VectorXd& driven, const FramePrior& frame)
        : expected_(prior.expectation()),
          settings_(expected_scale(prior)),
          walls_(distances_of(prior, rows, driven, frame)) {}

    Index num_unknown() const { return static_cast<Index>(2 * walls_.size() + 1); }
    WallMotionScale scale_at(const Eigen::VectorXd& x) const {
        WallMotionScale scale;
        const std::size_t n = walls_.size();
        for (std::size_t w = 0; w < n; ++w) {
            if (walls_[w].rows.empty()) {  // nothing shows another
                scale.walls.push_back(settings_.walls[w]);
                continue;
            }
            scale.walls.push_back(
                // median exp(spread x): x ~ N(0, 1) is a log-normal prior
                {normal_median_mm * std::exp(normal_spread * x[n + w]),
                 std::max(least_range_mm, range_median_mm * std::exp(range_spread * x[w]))});
        }
        scale.rigid_mm = rigid_of(expected_);
        scale.tangential = tangential_median * std::exp(tangential_spread * x[2 * n]);
        return scale;
    }
    /// `scale_at` of it is `scale`, as far as the search goes.
    Eigen::VectorXd position_of(const WallMotionScale& scale) const {
        Eigen::VectorXd x(num_unknown());
        const std::size_t n = walls_.size();
        for (std::size_t w = 0; w < n; ++w) {
            x[w] = std::log(scale.walls[w].range_mm / range_median_mm) / range_spread;
            x[n + w] = std::log(scale.walls[w].normal_mm / normal_median_mm) / normal_spread;
        }
        x[2 * n] = std::log(scale.tangential / tangential_median) / tangential_spread;
        return x.cwiseMax(-farthest).cwiseMin(farthest);
    }
    double cost(const Eigen::VectorXd& x) const {
        const WallMotionScale scale = scale_at(x);
        std::vector<double> costs(walls_.size());
        const SerialBlas serial;
        parallel_ranges(static_cast<Index>(walls_.size()), 1, [&](Index begin, Index end) {
            for (Index w = begin; w < end; ++w)
                costs[w] = cost_of(walls_[w], scale.walls[w],
                                   tangential_of(scale.walls[w], scale.tangential));
        });
        double sum = 0;
        for (const double one : costs) sum += one;
        // plus x^2 / 2 of each, that prior
        for (Index k = 0; k < num_unknown(); ++k) sum += 0.5 * x[k] * x[k];
        return std::isfinite(sum) ? sum : 1e30;
    }

private:
    const WallExpectation& expected_;
    WallMotionScale settings_;  ///< what they say, for walls that are not seen
    std::vector<Distances> walls_;
};

}  // namespace

WallMotionScale expected_scale(const WallPrior& prior) {
    const WallExpectation& expected = prior.expectation();
    WallMotionScale scale;
    scale.walls.assign(prior.walls().size(),
                       {normal_of_sd * expected.sd_mm, range_of_range * expected.range_mm});
    scale.tangential = tangential_median;
    scale.rigid_mm = rigid_of(expected);
    return scale;
}

WallMotionScale fit_walls(const WallPrior& prior, const std::vector<LinearRow>& rows,
                          const Eigen::VectorXd& driven, const FramePrior& frame) {
    const Evidence evidence(prior, rows, driven, frame);
    const auto cost = [&](const Eigen::VectorXd& x) { return evidence.cost(x); };
    // However it ends, its best point counts.
    const NloptMinimum best =
        minimise_in_trust_region(cost, evidence.position_of(expected_scale(prior)),
                                 {-farthest, farthest, first_step, tolerance, most_trials});
    return evidence.scale_at(best.x);
}

std::shared_ptr<const WallPrior> walls_of(const WallPrior& prior, const WallMotionScale& scale) {
    const WallExpectation& expected = prior.expectation();
    std::vector<WallPrior::Wall> walls;
    for (std::size_t w = 0; w < prior.walls().size(); ++w) {
        const std::vector<Index>& nodes = prior.walls()[w].nodes;
        const Index n = static_cast<Index>(nodes.size());
        WallPrior::Wall wall{nodes,
                             Eigen::MatrixXd(n, n),
                             {},
                             tangential_of(scale.walls[w], scale.tangential),
                             rigid_motions(places_of(prior, w), scale.rigid_mm)};
        wall.normals.resize(n, 3);
        const double variance = std::pow(scale.walls[w].normal_mm, 2);
        for (Index j = 0; j < n; ++j) {
            wall.normals.row(j) = expected.normals[nodes[j]];
            // s^2 k(d_ij) along the normals; `Wall` adds tangential motion and the body's
            // (method.md, 3.1)
            wall.covariance(j, j) = variance * (1.0 + nugget);
            for (Index i = j + 1; i < n; ++i)
                wall.covariance(i, j) = wall.covariance(j, i) =
                    variance *
                    matern32((expected.places[nodes[i]] - expected.places[nodes[j]]).norm(),
                             scale.walls[w].range_mm);
        }
        walls.push_back(std::move(wall));
    }
    return std::make_shared<WallPrior>(prior, std::move(walls));
}

}  // namespace palpate
