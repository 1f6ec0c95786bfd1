// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/joint_estimate.hpp"

#include <fmt/core.h>

#include <cmath>

#include "host/apps/recover/inverse/joint_problem.hpp"
#include "host/apps/recover/modelling/regions.hpp"
#include "host/apps/recover/pipeline/judged_modulus.hpp"
#include "host/estimate/quasi_newton.hpp"

namespace palpate {
namespace {

/// What is left of the contours' error in the moduli's model, mm: that of the targets as they tell
/// of this modulus, less by the root of what the best of them tells of all.
double contours_left_mm(const std::vector<JointTarget>& targets, const Eigen::VectorXd& shares) {
    double weighted = 0;
    for (std::size_t a = 0; a < targets.size(); ++a)
        weighted += shares[static_cast<Index>(a)] * targets[a].noise.contour_mm;
    if (!(shares.sum() > 0)) return targets.front().noise.contour_mm;
    return weighted / shares.sum() * std::sqrt(shares.maxCoeff());
}

/// What the size of the elements has changed of modulus `k`: of the targets as they tell of it.
double mesh_change_ln(const std::vector<JointTarget>& targets, const Eigen::VectorXd& shares,
                      Index k) {
    double weighted = 0;
    for (std::size_t a = 0; a < targets.size(); ++a)
        if (targets[a].mesh_change_ln.size() > 0)
            weighted += shares[static_cast<Index>(a)] * targets[a].mesh_change_ln[k];
    return shares.sum() > 0 ? weighted / shares.sum() : 0;
}

}  // namespace

JointTarget joint_target(const MapEstimate& estimate, const Settings& settings) {
    return {estimate.posterior,   estimate.walls,          estimate.response,
            estimate.noise_level, estimate.mesh_change_ln, why_told_alone(estimate, settings)};
}

std::vector<RegionResult> joint_estimate(const std::vector<JointTarget>& targets,
                                         const Settings& settings, const MapOptions& options,
                                         const ProgressSink& progress) {
    MapEstimate all;
    all.unknown = targets.front().problem->unknowns();
    if (all.unknown.empty()) return {};
    report_progress(progress, "joint", 0, fmt::format("{} targets together", targets.size()));
    std::vector<std::shared_ptr<const LinearisedProblem>> problems;
    for (const JointTarget& target : targets) problems.push_back(target.problem);
    const JointProblem problem(problems);
    const Bounds bounds = same_bounds(problem.num_unknown(), std::log(options.smallest_kpa),
                                      std::log(options.largest_kpa));
    all.theta = minimise_bfgs(problem, scan_grid(problem, bounds), bounds).theta;
    take_uncertainty(problem, options, all, progress);
    const Eigen::MatrixXd shares = problem.shares(all.theta);
    all.mesh_change_ln.resize(all.theta.size());
    for (Index k = 0; k < all.theta.size(); ++k)
        all.mesh_change_ln[k] = mesh_change_ln(targets, shares.col(k), k);
    std::vector<RegionResult> regions;
    for (std::size_t k = 0; k < all.unknown.size(); ++k) {
        RegionResult region;
        region.region = all.unknown[k].object;
        region.name = name_of_region(settings, region.region);
        region.unknown = true;
        all.noise_level.contour_mm = contours_left_mm(targets, shares.col(static_cast<Index>(k)));
        judge_modulus(all, k, settings, region);
        regions.push_back(std::move(region));
    }
    return regions;
}

}  // namespace palpate
