// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "host/estimate/data_problem.hpp"

namespace palpate {

/// The same experiment before anyone measures: what is measured will be what the model says at the
/// parameters' starts. Where and when, and the noise, are those of the tables.
class PlannedProblem : public DataProblem {
public:
    /// `problem` must outlive this. Throws Error(solve_failed) if it has no prediction there.
    explicit PlannedProblem(const DataProblem& problem);

    const std::vector<Parameter>& parameters() const override { return problem_.parameters(); }
    PredictionAttempt predict(const Eigen::VectorXd& values, PredictedColumns columns,
                              const Prediction* warm) const override;

private:
    const DataProblem& problem_;
    std::vector<Eigen::VectorXd> expected_;  ///< of each block
};

}  // namespace palpate
