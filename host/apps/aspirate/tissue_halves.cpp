// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_halves.hpp"

#include <algorithm>
#include <cmath>

#include "host/apps/aspirate/model/aspiration_model.hpp"
#include "host/apps/identify/resolution.hpp"

namespace palpate {
namespace {

/// For tissue and a surface at rest that differ by less, what halves change is nearly the same: of
/// 16 films one number moved by 0.1 sd against halves at the end, others by less than 0.06.
constexpr double near_ln = 0.1, near_rest_mm = 0.05;
/// Bulk modulus over Young's modulus at the peak where halves are solved, at most: of 16 films one
/// number moved by 0.14 sd against 500, others by less than 0.05, gamma nearly always down by 0.1
/// %; and Newton's method takes a third fewer steps.
constexpr double kappa_of_halves = 50;

struct Pair {
    std::vector<Resizing> usual, halved;
};

const std::array<Pair, TissueHalves::num_pair>& all_pairs() {
    static const std::array<Pair, TissueHalves::num_pair> pairs{
        {{{double_steps}, {halve_cells, double_steps}},
         {{double_cells}, {halve_steps, double_cells}}}};
    return pairs;
}

}  // namespace

bool is_of_model(const Error& error) {
    return error.code() == ErrorCode::solve_failed || error.code() == ErrorCode::mesh_failed ||
           error.code() == ErrorCode::invalid_argument || error.code() == ErrorCode::input_unusable;
}

ExperimentProblem resized_problem(const Experiment& experiment,
                                  const std::vector<Resizing>& resizings,
                                  const SolvingOptions& solving, double kappa_over_young) {
    return {
        experiment,
        [configure = solving.configure, resizings,
         kappa_kpa = kappa_over_young * solving.peak_stiffness_kpa](SimulationSettings& settings) {
            configure(settings);
            limit_bulk_modulus(kappa_kpa, settings);
            for (const Resizing resized : resizings)
                if (!resized(settings))
                    throw Error(ErrorCode::solve_failed, "its cells and steps stay as they are");
        },
        solving.jobs, solving.progress};
}

bool are_near(const SearchPlace& first, const SearchPlace& second) {
    if (std::abs(second.moved_mm - first.moved_mm) > near_rest_mm) return false;
    const std::vector<Parameter>& parameters = second.experiment->parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const Parameter& one = parameters[k];
        const auto at = Eigen::Index(k);
        const double apart =
            to_transformed(one, second.values[at]) - to_transformed(one, first.values[at]);
        const double most = one.transform == Transform::log ? near_ln
                            : one.has_prior()               ? one.sd
                                                            : 0.0;
        if (!(std::abs(apart) <= most)) return false;
    }
    return true;
}

bool TissueHalves::can_halve(const SearchPlace& place) {
    for (const Pair& pair : all_pairs())
        for (const std::vector<Resizing>& resizings : {pair.usual, pair.halved}) {
            SimulationSettings settings = *place.experiment->at(place.values).simulation;
            for (const Resizing resized : resizings)
                if (!resized(settings)) return false;
        }
    return true;
}

/// Null where other cells or steps cannot do it: that is no reason to lose the fit.
std::shared_ptr<const Prediction> TissueHalves::resized_prediction(
    const SearchPlace& place, const std::vector<Resizing>& resizings, const Prediction* warm) {
    const ExperimentProblem resized =
        resized_problem(*place.experiment, resizings, solving_, kappa_of_halves);
    std::shared_ptr<const Prediction> made;
    try {
        if (warm)
            made =
                checked_prediction(resized, place.values, PredictedColumns::none, warm).prediction;
        // From a guess a load is given up early; without one it never is.
        if (!made)
            made = checked_prediction(resized, place.values, PredictedColumns::none, nullptr)
                       .prediction;
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
    }
    num_simulation_ += resized.num_simulation();
    return made;
}

void TissueHalves::halve(std::size_t pair, const SearchPlace& place) {
    HalvedModel& one = halved_[pair];
    one.usual = resized_prediction(place, all_pairs()[pair].usual, place.guess.get());
    if (one.usual)
        one.halved = resized_prediction(place, all_pairs()[pair].halved, one.usual.get());
}

bool TissueHalves::are_halved() const {
    return std::all_of(halved_.begin(), halved_.end(),
                       [](const HalvedModel& one) { return one.halved; });
}

std::vector<HalvedModel> TissueHalves::pairs() const {
    if (!are_halved()) return {};
    return {halved_.begin(), halved_.end()};
}

}  // namespace palpate
