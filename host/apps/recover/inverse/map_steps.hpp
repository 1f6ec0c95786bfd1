// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "host/apps/recover/inverse/linearised_problem.hpp"
#include "host/apps/recover/inverse/map_options.hpp"
#include "host/apps/recover/inverse/surface_noise.hpp"
#include "host/apps/recover/observations/surface_observations.hpp"
#include "host/estimate/quasi_newton.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Weight of ln E beside one component of the walls' motion in mm, for Anderson's acceleration.
constexpr double search_mm_per_unit_ln = 10.0;

/// What is searched for.
struct SearchPosition {
    Eigen::VectorXd driven;
    FrameMotion frame = FrameMotion::Zero();
    Eigen::VectorXd theta;

    /// Part of the way to another.
    SearchPosition towards(const SearchPosition& other, double t) const {
        return {driven + t * (other.driven - driven), frame + t * (other.frame - frame),
                theta + t * (other.theta - theta)};
    }
    /// As one vector, in which a unit of each has about the same weight.
    Eigen::VectorXd scaled() const {
        Eigen::VectorXd all(driven.size() + 6 + theta.size());
        all << driven, frame, search_mm_per_unit_ln * theta;
        return all;
    }
};

/// A place of the search and what is known there.
struct SearchState : SearchPosition {
    Eigen::VectorXd observed;
    ObservedState seen;
    std::shared_ptr<const CountedRows> counted;  ///< the rows that the objective is over
    double objective = 0;                        ///< nonlinear, without the determinant
};

/// Largest absolute value; 0 of none.
double largest(const Eigen::VectorXd& vector);

/// Of ln E, as the options say.
Bounds map_bounds(const MapOptions& options, Index num_unknown);

/// What the steps of a search are made of: the nonlinear objective and its linearisation, the rows
/// that count, the size of their noise, the walls' prior, and how walls come near their targets.
/// `model`, `walls`, `observations`, `unknowns`, `options` and `progress` must outlive it.
class MapSteps {
public:
    MapSteps(const ResponseModel& model, const WallPrior& walls,
             const SurfaceObservations& observations, const std::vector<Unknown>& unknowns,
             const MapOptions& options, const ProgressSink& progress)
        : model_(std::shared_ptr<void>(), &model),
          walls_(std::shared_ptr<void>(), &walls),
          observations_(observations),
          noise_(observations),
          unknowns_(unknowns),
          options_(options),
          progress_(progress),
          bounds_(map_bounds(options, static_cast<Index>(unknowns.size()))) {}

protected:
    using Counted = std::shared_ptr<const CountedRows>;

    /// Without `counted` all rows that are seen there count.
    SearchState state_at(const SearchPosition& position, const Counted& counted) const;
    /// The same place, its objective over what is seen there with the noise that it has there.
    SearchState recounted(SearchState state) const;
    LinearisedProblem linearise(const SearchState& state) const;
    SearchState settle_walls(SearchState state, bool is_smooth = false) const;
    SearchState settle_bodies(SearchState state);
    SearchState settle_first(SearchState state);
    SearchState search_line(const SearchState& from, const SearchPosition& to,
                            double determinant_change, double& length) const;
    NoiseLevel first_level() const;
    NoiseLevel level_for(const LinearisedProblem::Fit& fit) const;
    bool can_fit_walls(const SearchState& state) const;
    SearchState with_fitted_walls(SearchState state);
    void take_walls(const std::shared_ptr<const WallPrior>& walls);

    std::shared_ptr<const ResponseModel> model_;
    std::shared_ptr<const WallPrior> walls_;
    bool are_walls_fitted_ = false;
    const SurfaceObservations& observations_;
    SurfaceNoise noise_;
    Counted held_;  ///< of an earlier estimate: these rows count, with their noise. Empty: a fresh
                    ///< search.
    const std::vector<Unknown>& unknowns_;
    const MapOptions& options_;
    const ProgressSink& progress_;
    Bounds bounds_;

private:
    double objective_of(const SearchState& state) const;
    std::vector<LinearRow> rows_of(const SearchState& state) const;
    FramePrior frame_of(const SearchState& state) const;
    double scale_for(const LinearisedProblem::Fit& fit) const;
    SurfaceNoise::FoundContours contours_for(const LinearisedProblem::Fit& fit) const;

    /// At the moduli of the last state; that walls are fitted does not change it.
    mutable std::optional<std::pair<Eigen::VectorXd, ResponseModel::Equilibrium>> equilibrium_;
};

}  // namespace palpate
