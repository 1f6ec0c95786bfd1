// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/plan.hpp"

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "host/apps/recover/inverse/identifiability.hpp"
#include "host/apps/recover/inverse/joint_problem.hpp"
#include "host/apps/recover/inverse/model_error.hpp"
#include "host/apps/recover/inverse/surface_noise.hpp"
#include "host/apps/recover/inverse/wall_fit.hpp"
#include "host/apps/recover/modelling/regions.hpp"
#include "host/apps/recover/pipeline/observed_target.hpp"
#include "host/apps/recover/pipeline/search_target.hpp"
#include "host/apps/recover/pipeline/target_state.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double supposed_factors[] = {1.0 / 3, 1.0, 3.0};  // of the prior's median
constexpr std::pair<int, int> planned_targets[] = {{1, 0}, {2, 0}, {4, 0}, {1, 1}, {2, 2}};

/// The reference with its surfaces, seen once more as its own target.
class Planner {
public:
    Planner(const PreparedReference& prepared, const SurfaceObservations& observations,
            const PlanOptions& plan, const Settings& settings)
        : prepared_(prepared),
          mechanics_(prepared.mechanics),
          plan_(plan),
          contour_mm_(planned_contour_mm(plan, settings)),
          walls_(walls_of(mechanics_.walls, expected_scale(mechanics_.walls))),
          response_(mechanics_.response.with_walls(*walls_)),
          observations_(observations) {
        SurfaceNoise noise(observations_);
        const ObservedState still =
            observations_.evaluate(Eigen::VectorXd::Zero(response_.driven_dofs()),
                                   Eigen::VectorXd::Zero(3 * mechanics_.recovery.observed.size()));
        noise.set_level({1, std::numbers::sqrt2 * contour_mm_});
        noise.take_terraces(still);
        ObservedState exact = still;
        exact.residual_mm.setZero();
        const auto counted = noise.count(exact);
        rows_ = counted->linear_rows(exact, true);
        frame_ = counted->frame();
    }

    std::vector<PlanRow> rows(const Settings& settings) const;

private:
    Eigen::VectorXd wall_motion() const;
    std::shared_ptr<const LinearisedProblem> problem(const Eigen::VectorXd& driven,
                                                     const Eigen::VectorXd& theta) const;
    PlannedInterval interval(const std::pair<int, int>& targets, const Eigen::VectorXd& theta,
                             Index unknown) const;
    Eigen::VectorXd observed(const Eigen::VectorXd& theta) const;
    double moved_mm(Index region, const Eigen::VectorXd& observed) const;

    const PreparedReference& prepared_;
    const Mechanics& mechanics_;
    PlanOptions plan_;
    double contour_mm_;
    std::shared_ptr<const WallPrior> walls_;
    ResponseModel response_;
    const SurfaceObservations& observations_;
    std::vector<LinearRow> rows_;  ///< of the surfaces where they are, without residual
    FramePrior frame_;
};

Eigen::VectorXd Planner::wall_motion() const {
    const WallExpectation& expected = mechanics_.walls.expectation();
    Eigen::VectorXd driven(response_.driven_dofs());
    for (std::size_t k = 0; k < expected.normals.size(); ++k)
        driven.segment<3>(3 * static_cast<Index>(k)) = plan_.motion_mm * expected.normals[k];
    return driven;
}

Eigen::VectorXd Planner::observed(const Eigen::VectorXd& theta) const {
    std::vector<Index> unknown;
    for (const Unknown& modulus : mechanics_.unknowns) unknown.push_back(modulus.object);
    return response_.observed_displacement(response_.moduli(unknown, theta), wall_motion());
}

/// A target that shows exactly this motion.
std::shared_ptr<const LinearisedProblem> Planner::problem(const Eigen::VectorXd& driven,
                                                          const Eigen::VectorXd& theta) const {
    const double side = driven.dot(wall_motion()) < 0 ? -1.0 : 1.0;
    return std::make_shared<LinearisedProblem>(response_, *walls_, rows_, driven,
                                               side * observed(theta), mechanics_.unknowns, frame_);
}

PlannedInterval Planner::interval(const std::pair<int, int>& targets, const Eigen::VectorXd& theta,
                                  Index unknown) const {
    std::vector<std::shared_ptr<const LinearisedProblem>> problems(targets.first,
                                                                   problem(wall_motion(), theta));
    problems.resize(targets.first + targets.second, problem(-wall_motion(), theta));
    const JointProblem all(problems);
    const double contours_mm =
        std::numbers::sqrt2 * contour_mm_ * std::sqrt(all.shares(theta).col(unknown).maxCoeff());
    PlannedInterval interval{targets.first, targets.second, 0, true};
    interval.sd_ln =
        sd_ln_with_model_error(std::sqrt(laplace_covariance(all, theta)(unknown, unknown)),
                               mechanics_.unknowns[unknown].sd, model_sd_ln_with(contours_mm));
    ModulusEvidence evidence;
    evidence.sd_ln = interval.sd_ln;
    evidence.prior_sd_ln = mechanics_.unknowns[unknown].sd;
    evidence.seen_sd_ln = seen_sd(all.seen_information(theta), mechanics_.unknowns)[unknown];
    interval.is_identifiable = judge(evidence).verdict != Verdict::not_identifiable;
    return interval;
}

double Planner::moved_mm(Index region, const Eigen::VectorXd& observed) const {
    double squares = 0;
    Index count = 0;
    for (const Observation& row : observations_.rows()) {
        if (row.on_driven || mechanics_.recovery.surfaces[row.surface].region != region) continue;
        squares += observed.segment<3>(3 * row.position).squaredNorm();
        ++count;
    }
    return std::sqrt(squares / double(std::max<Index>(1, count)));
}

std::vector<PlanRow> Planner::rows(const Settings& settings) const {
    std::vector<PlanRow> rows;
    const Index num_unknown = static_cast<Index>(mechanics_.unknowns.size());
    for (Index k = 0; k < num_unknown; ++k) {
        for (const double factor : supposed_factors) {
            Eigen::VectorXd theta(num_unknown);
            for (Index other = 0; other < num_unknown; ++other)
                theta[other] = mechanics_.unknowns[other].mean;
            theta[k] += std::log(factor);
            PlanRow row;
            row.region = name_of_region(settings, mechanics_.unknowns[k].object);
            row.supposed_kpa = std::exp(theta[k]);
            row.moved_mm = moved_mm(mechanics_.unknowns[k].object, observed(theta));
            for (const auto& targets : planned_targets)
                row.intervals.push_back(interval(targets, theta, k));
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

}  // namespace

double planned_contour_mm(const PlanOptions& plan, const Settings& settings) {
    return plan.contour_mm.value_or(settings.prior.contour_sd_mm.value_or(usual_contour_mm));
}

std::vector<PlanRow> plan_recovery(const Segmentation& reference, const RecoverOptions& options,
                                   const PlanOptions& plan, const ProgressSink& progress) {
    StageTimer timer;
    if (options.settings.has_unknown_poisson_ratio())
        throw Error(ErrorCode::input_unusable,
                    "a Poisson's ratio is unknown, of which a plan cannot tell; give it as a "
                    "number");
    RecoverOptions still = options;
    if (!options.initial_transform.empty()) still.align = AlignMethod::none;
    still.initial_transform.clear();
    report_progress(progress, "reading", 0, "smoothing the segmentation");
    ReferenceState state =
        make_reference(make_state(reference, options.settings), options, progress);
    const TargetState itself =
        align_target(make_state(reference, options.settings), state, still, progress);
    const TargetShapes shapes = target_shapes(itself, options.settings);
    const PreparedReference prepared =
        prepare_reference(std::move(state), options, timer, progress);
    const Mechanics& mechanics = prepared.mechanics;
    if (mechanics.unknowns.empty())
        throw Error(ErrorCode::input_unusable,
                    "the settings leave no modulus to be found; set stiffness_kpa = \"unknown\"");
    if (mechanics.walls.expectation().normals.empty())
        throw Error(ErrorCode::input_unusable,
                    "no wall is driven, so nothing would move; give an organ role = \"driven\"");
    ObservedShapes both;
    for (const DistanceMap& map : prepared.maps)
        both.reference.emplace_back(std::shared_ptr<void>(), &map);
    both.target = shapes;
    const std::vector<std::uint8_t> all(prepared.mesh.mesh.nodes.size(), 1);
    const SurfaceObservations observations(
        mechanics.recovery, both, all,
        observation_options(options.settings, prepared.reference.state, itself));
    report_progress(progress, "planning", 0, "what targets would tell");
    return Planner(prepared, observations, plan, options.settings).rows(options.settings);
}

}  // namespace palpate
