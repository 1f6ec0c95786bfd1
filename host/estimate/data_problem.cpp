// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/data_problem.hpp"

#include <fmt/core.h>

#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuse_block(const DataBlock& block, const std::string& what) {
    throw Error(ErrorCode::internal, fmt::format("data \"{}\": {}", block.name, what));
}

void check_rows(const DataBlock& block, Index found, const char* what) {
    if (found != block.num_row())
        refuse_block(
            block, fmt::format("{} rows of {}, but {} measurements", found, what, block.num_row()));
}

void check_shape(const DataBlock& block, PredictedColumns columns, Index num_parameter) {
    check_rows(block, block.predicted.size(), "predictions");
    check_rows(block, block.sd.size(), "sd");
    if (block.position_mm.size() > 0) check_rows(block, block.position_mm.rows(), "positions");
    if (block.position_mm.cols() > 3) refuse_block(block, "a position has more than 3 coordinates");
    if (block.time_s.size() > 0) check_rows(block, block.time_s.size(), "times");
    if (columns == PredictedColumns::none) return;
    check_rows(block, block.columns.rows(), "columns");
    if (block.columns.cols() != num_parameter)
        refuse_block(block, fmt::format("{} columns for {} parameters", block.columns.cols(),
                                        num_parameter));
}

void check_data(const DataBlock& block) {
    for (Index i = 0; i < block.num_row(); ++i) {
        if (!std::isfinite(block.measured[i]))
            throw Error(ErrorCode::input_unusable,
                        fmt::format("data \"{}\": row {} is no finite number; leave it out",
                                    block.name, i + 1));
        if (!(block.sd[i] > 0) || !std::isfinite(block.sd[i]))
            throw Error(ErrorCode::input_unusable,
                        fmt::format("data \"{}\": the sd of row {}, {:g} {}, is not above 0",
                                    block.name, i + 1, block.sd[i], block.unit));
    }
}

PredictionAttempt attempt(const DataProblem& problem, const Eigen::VectorXd& values,
                          PredictedColumns columns, const Prediction* warm) {
    try {
        return problem.predict(values, columns, warm);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        return {nullptr, error.what()};
    }
}

}  // namespace

const Prediction* solved_of(const Prediction* prediction) {
    return prediction && prediction->solved ? prediction->solved.get() : prediction;
}

PredictionAttempt checked_prediction(const DataProblem& problem, const Eigen::VectorXd& values,
                                     PredictedColumns columns, const Prediction* warm) {
    PredictionAttempt made = attempt(problem, values, columns, solved_of(warm));
    if (!made.prediction) {
        if (made.failure.empty()) made.failure = "the model could not be solved";
        return made;
    }
    if (made.prediction->values != values)
        throw Error(ErrorCode::internal, "a prediction is not of the values that were asked for");
    for (const DataBlock& block : made.prediction->blocks) {
        check_shape(block, columns, values.size());
        check_data(block);
        if (!block.predicted.allFinite() || !block.columns.allFinite())
            return {nullptr, fmt::format("the prediction of \"{}\" is not finite", block.name)};
    }
    return made;
}

Eigen::MatrixXd transformed_columns(const DataBlock& block, const Eigen::VectorXd& slopes) {
    // dy/dt = dy/dv dv/dt
    return block.columns * slopes.asDiagonal();
}

}  // namespace palpate
