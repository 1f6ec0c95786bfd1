// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/map_steps.hpp"

#include <algorithm>
#include <cmath>

#include "host/apps/recover/inverse/wall_fit.hpp"
#include "host/estimate/posterior.hpp"

namespace palpate {
namespace {

constexpr int most_settling_steps = 10;
constexpr double stiff_share = 0.25, body_share = 3.0;
constexpr double other_tangential = 3.0;
constexpr double first_contour_mm = 1.0, least_contour_mm = 0.05;
/// How far single points may be off by themselves, in what voxels leave, where contours' errors are
/// looked for: what is more is theirs. Taken for independent, it would make 400 points of about 50.
constexpr double most_point_scale = 1.3, most_given_point_scale = 20.0;

}  // namespace

double largest(const Eigen::VectorXd& vector) {
    return vector.size() == 0 ? 0.0 : vector.cwiseAbs().maxCoeff();
}

Bounds map_bounds(const MapOptions& options, Index num_unknown) {
    return same_bounds(num_unknown, std::log(options.smallest_kpa), std::log(options.largest_kpa));
}

SearchState MapSteps::state_at(const SearchPosition& position, const Counted& counted) const {
    std::vector<Index> unknown;
    for (const Unknown& one : unknowns_) unknown.push_back(one.object);
    if (!equilibrium_ || equilibrium_->first != position.theta)
        equilibrium_ = {position.theta,
                        model_->equilibrium_at(model_->moduli(unknown, position.theta))};
    SearchState state{position,
                      model_->observed_displacement(equilibrium_->second, position.driven),
                      {},
                      counted,
                      0};
    state.seen = observations_.evaluate(state.driven, state.observed, state.frame);
    if (!counted) return recounted(std::move(state));
    state.objective = objective_of(state);
    return state;
}

double MapSteps::objective_of(const SearchState& state) const {
    return state.counted->misfit(state.seen.residual_mm) + walls_->energy(state.driven) +
           state.counted->energy(state.frame) + prior_energy(unknowns_, state.theta);
}

SearchState MapSteps::recounted(SearchState state) const {
    state.counted = held_ ? held_ : noise_.count(state.seen);
    state.objective = objective_of(state);
    return state;
}

std::vector<LinearRow> MapSteps::rows_of(const SearchState& state) const {
    return state.counted->linear_rows(state.seen);
}

LinearisedProblem MapSteps::linearise(const SearchState& state) const {
    check_cancelled(progress_);
    return LinearisedProblem(*model_, *walls_, rows_of(state), state.driven, state.observed,
                             unknowns_, frame_of(state));
}

FramePrior MapSteps::frame_of(const SearchState& state) const {
    FramePrior frame = state.counted->frame();
    frame.motion = state.frame;
    return frame;
}

/// Brings the driven walls near their targets with the moduli held, before anything is concluded
/// from the observed surfaces.
SearchState MapSteps::settle_walls(SearchState state, bool is_smooth) const {
    for (int k = 0; k < most_settling_steps; ++k) {
        double length = 0;
        const WallPosterior walls(*walls_, state.counted->linear_rows(state.seen, is_smooth),
                                  state.driven, frame_of(state));
        const SearchState next =
            search_line(state, {walls.mean(), walls.frame_mean(), state.theta}, 0.0, length);
        const double moved = largest(next.driven - state.driven);
        state = recounted(next);
        if (length == 0 || moved < 0.1) break;
    }
    return state;
}

/// The same as bodies that hardly change their shape, then with the shape that they are expected to
/// take: where a wall has slid along itself far, closest points would hold it where it is.
SearchState MapSteps::settle_bodies(SearchState state) {
    const auto asked = walls_;
    WallMotionScale scale = expected_scale(*asked);
    for (auto& wall : scale.walls) wall.normal_mm *= stiff_share;
    scale.rigid_mm *= body_share;
    for (int k = 0; k < 2; ++k) {
        walls_ = walls_of(*asked, k == 0 ? scale : expected_scale(*asked));
        state = settle_walls(recounted(std::move(state)), true);
    }
    walls_ = asked;
    return recounted(std::move(state));
}

/// The same as the options say.
SearchState MapSteps::settle_first(SearchState state) {
    if (options_.first_walls == FirstWalls::bodies) return settle_bodies(std::move(state));
    const auto asked = walls_;
    const bool slides = options_.first_walls == FirstWalls::sliding;
    WallMotionScale scale = expected_scale(*asked);
    for (auto& wall : scale.walls) wall.range_mm *= slides ? 0.5 : 2.0;
    scale.tangential *= slides ? other_tangential : 1 / other_tangential;
    walls_ = walls_of(*asked, scale);
    for (int k = 0; k < 3; ++k) state = settle_walls(recounted(std::move(state)), true);
    walls_ = asked;
    return recounted(std::move(state));
}

/// Line search on the nonlinear objective, with the determinant of this linearisation (taken as
/// linear along the step). Gauss-Newton leaves out how the surfaces curve, so in some directions it
/// goes twice too far, step after step: a parabola through three points finds the right length.
SearchState MapSteps::search_line(const SearchState& from, const SearchPosition& to,
                                  double determinant_change, double& length) const {
    SearchState best = from;
    double lowest = from.objective;
    length = 0;
    const auto offer = [&](double t) {
        check_cancelled(progress_);
        SearchState trial = state_at(from.towards(to, t), from.counted);
        const double value = trial.objective + t * 0.5 * determinant_change;
        if (std::isfinite(value) && value <= lowest) {
            lowest = value;
            length = t;
            best = std::move(trial);
        }
        return value;
    };
    const double whole = offer(1.0);
    const double half = offer(0.5);
    const double bend = 2.0 * (whole + from.objective - 2.0 * half);
    const double slope = 4.0 * half - 3.0 * from.objective - whole;
    if (bend > 0 && slope < 0) offer(std::clamp(-0.5 * slope / bend, 0.1, 1.5));
    for (double t = 0.25; length == 0 && t > 1e-3; t *= 0.5) offer(t);
    return best;
}

NoiseLevel MapSteps::first_level() const {
    const double contours =
        options_.contour_mm.value_or(options_.estimate_noise ? first_contour_mm : 0.0);
    return {std::max(1.0, options_.smallest_noise_scale), contours,
            options_.slice_share.value_or(0.0)};
}

NoiseLevel MapSteps::level_for(const LinearisedProblem::Fit& fit) const {
    NoiseLevel level = noise_.level();
    if (!options_.estimate_noise) return level;
    double shown_share = 1;
    if (!options_.contour_mm) {
        const SurfaceNoise::FoundContours found = contours_for(fit);
        level.contour_mm = std::clamp(found.sd_mm, least_contour_mm, most_contour_mm);
        shown_share = found.shown_share;
    }
    level.scale = scale_for(fit);
    // What the rows do not show, they do not show to be slice by slice either.
    const double slice_share = options_.slice_share.value_or(shown_share * fit.slice_share);
    level.slice_share = level.contour_mm > 0 ? slice_share : 0.0;
    return level;
}

/// sigma_n^2 such that the observed residual has the size that its own model predicts:
/// E[r^T R^-1 r] = tr(R C^-1) for r = R C^-1 e.
double MapSteps::scale_for(const LinearisedProblem::Fit& fit) const {
    if (fit.effective_rows < 1) return noise_.level().scale;
    const double factor = std::clamp(std::sqrt(fit.weighted_misfit / fit.effective_rows), 0.5, 2.0);
    const double most = options_.contour_mm ? most_given_point_scale : most_point_scale;
    return std::clamp(noise_.level().scale * factor, options_.smallest_noise_scale,
                      std::max(most, options_.smallest_noise_scale));
}

/// The contours' error such that E[r^T D r] = tr(D R C^-1 R). Not weighted by R^-1: that asks the
/// shortest waves, where the kernel is least certain and moduli do not show.
SurfaceNoise::FoundContours MapSteps::contours_for(const LinearisedProblem::Fit& fit) const {
    if (!(fit.expected_misfit_mm2 > 0)) return {noise_.level().contour_mm, 1};
    return noise_.contours_for(fit.misfit_mm2 / fit.expected_misfit_mm2);
}

/// Where no modulus is asked for, walls move as the settings say: the fit is for what moduli see.
bool MapSteps::can_fit_walls(const SearchState& state) const {
    const std::vector<LinearRow> rows = rows_of(state);
    const bool any = std::any_of(rows.begin(), rows.end(), [](auto& row) { return row.on_driven; });
    return options_.fit_walls && any && !unknowns_.empty() &&
           !walls_->expectation().normals.empty();
}

/// What is expected of the walls' motion becomes what their own distances show of it.
SearchState MapSteps::with_fitted_walls(SearchState state) {
    if (!can_fit_walls(state)) return state;
    const WallMotionScale scale = fit_walls(*walls_, rows_of(state), state.driven, frame_of(state));
    take_walls(walls_of(*walls_, scale));
    return recounted(std::move(state));
}

void MapSteps::take_walls(const std::shared_ptr<const WallPrior>& walls) {
    if (!walls) return;
    walls_ = walls;
    model_ = std::make_shared<ResponseModel>(model_->with_walls(*walls));
    are_walls_fitted_ = true;
}

}  // namespace palpate
