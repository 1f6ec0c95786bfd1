// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/discretisation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double all_of_second_order = 4.0 / 3.0;
/// What is not known of a shift: a share of it where it is small beside the sd, all of it from
/// three sd on, where a first-order correction is a guess.
constexpr double least_unknown_share = 1.0 / 3.0, most_unknown_share = 1;
constexpr double shift_of_guess = 3;  // sd
constexpr double reach_95 = 1.959964;

/// An end of an interval, moved by `shift` and away from the value by an sd of `sd`.
double moved_end(const Parameter& parameter, double end, double centre, double shift, double sd) {
    if (!std::isfinite(end) || end <= parameter.lowest || end >= parameter.highest) return end;
    if (parameter.transform == Transform::log && !(end > 0)) return end;
    const double width = to_transformed(parameter, end) - centre;
    // The interval's own half width and the discretisation's are independent.
    const double wider = std::copysign(std::hypot(width, reach_95 * sd), width);
    return std::clamp(to_value(parameter, centre + shift + wider), parameter.lowest,
                      parameter.highest);
}

}  // namespace

Eigen::VectorXd shift_by_discretisation(const std::vector<Parameter>& parameters, const Fit& fit,
                                        const Prediction& finer, const Prediction& coarser) {
    const Eigen::VectorXd slopes = slopes_of(parameters, fit.transformed);
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(fit.transformed.size());
    for (std::size_t b = 0; b < fit.prediction->blocks.size(); ++b) {
        const DataBlock& block = fit.prediction->blocks[b];
        for (const Prediction* other : {&finer, &coarser})
            if (other->blocks.size() != fit.prediction->blocks.size() ||
                other->blocks[b].predicted.size() != block.predicted.size())
                throw Error(ErrorCode::internal, "a finer prediction has other rows");
        const Eigen::MatrixXd columns = transformed_columns(block, slopes);
        pull += columns.transpose() *
                fit.noise->covariance(static_cast<Index>(b))
                    .solve(finer.blocks[b].predicted - coarser.blocks[b].predicted);
    }
    NormalEquations equations{fit.equations.information, fit.equations.hessian, -pull};
    hold(parameters, equations);  // the pull on what is held is that of the others
    return equations.hessian.ldlt().solve(equations.gradient);
}

void correct_for_discretisation(const std::vector<Eigen::VectorXd>& shifts, const Fit& fit,
                                Identified& all, const Eigen::VectorXd& model_sd) {
    std::vector<Parameter> parameters;
    for (const IdentifiedParameter& one : all.parameters) parameters.push_back(one.parameter);
    for (std::size_t k = 0; k < all.parameters.size(); ++k) {
        IdentifiedParameter& found = all.parameters[k];
        // What is not known moves as far as it likes, and might leave its own interval.
        if (found.judgement.verdict == Verdict::not_identifiable) continue;
        const auto at = static_cast<Eigen::Index>(k);
        double shift = 0, squares = 0;
        for (const Eigen::VectorXd& one : shifts) {
            shift += all_of_second_order * one[at];
            squares += one[at] * one[at];
        }
        const double size = std::sqrt(squares);
        // Shifts of opposite signs are no less of a guess
        const double large = std::max(std::abs(shift), all_of_second_order * size);
        const double share = std::clamp(large / (shift_of_guess * found.sd), least_unknown_share,
                                        most_unknown_share);
        const double centre = fit.transformed[at], sd = share * size;
        found.discretisation_shift = shift;
        found.discretisation_sd = sd;
        found.value = std::clamp(to_value(found.parameter, centre + shift), found.parameter.lowest,
                                 found.parameter.highest);
        const bool has_model_error = model_sd.size() > 0 && !found.parameter.is_nuisance &&
                                     found.parameter.transform == Transform::log;
        const double wider = has_model_error ? std::hypot(sd, model_sd[at]) : sd;
        for (double& end : found.interval)
            end = moved_end(found.parameter, end, centre, shift, wider);
        found.judgement = judge_parameter(parameters, found);
    }
}

}  // namespace palpate
