// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/planned_problem.hpp"

#include <memory>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Keeps what it was made from, so that it stays a warm state.
struct PlannedPrediction : Prediction {
    std::shared_ptr<const Prediction> inner;
};

}  // namespace

PlannedProblem::PlannedProblem(const DataProblem& problem) : problem_(problem) {
    const PredictionAttempt start =
        problem.predict(starts_of(problem.parameters()), PredictedColumns::none, nullptr);
    if (!start.prediction) throw Error(ErrorCode::solve_failed, start.failure);
    for (const DataBlock& block : start.prediction->blocks) expected_.push_back(block.predicted);
}

PredictionAttempt PlannedProblem::predict(const Eigen::VectorXd& values, PredictedColumns columns,
                                          const Prediction* warm) const {
    const auto* planned = dynamic_cast<const PlannedPrediction*>(warm);
    PredictionAttempt attempt =
        problem_.predict(values, columns, planned ? planned->inner.get() : nullptr);
    if (!attempt.prediction) return attempt;
    auto made = std::make_shared<PlannedPrediction>();
    made->inner = attempt.prediction;
    made->values = attempt.prediction->values;
    made->blocks = attempt.prediction->blocks;
    for (std::size_t k = 0; k < expected_.size(); ++k) made->blocks[k].measured = expected_[k];
    return {made, ""};
}

}  // namespace palpate
