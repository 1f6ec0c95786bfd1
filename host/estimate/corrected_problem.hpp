// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/estimate/data_problem.hpp"

namespace palpate {

/// A cheap model of the same data that says at one place what an exact one says there:
///   predicted(p) = cheap(p) + exact(at) - cheap(at),
/// with the columns of the cheap one (an additive correction of order zero; Alexandrov and Lewis,
/// Optim. Eng. 2, 2001). What it has wrong at the exact model's optimum grows with the distance
/// from `at` times what the columns have wrong.
class CorrectedProblem : public DataProblem {
public:
    /// `cheap` must outlive this. Both predictions are at the same values. Throws
    /// Error(invalid_argument) if they are not, or have other blocks.
    CorrectedProblem(const DataProblem& cheap, const Prediction& exact_at,
                     std::shared_ptr<const Prediction> cheap_at);

    const std::vector<Parameter>& parameters() const override { return cheap_.parameters(); }
    PredictionAttempt predict(const Eigen::VectorXd& values, PredictedColumns columns,
                              const Prediction* warm) const override;
    /// What the cheap model alone says, of a prediction of this problem; null for any other.
    static std::shared_ptr<const Prediction> cheap_of(const Prediction& prediction);

private:
    const DataProblem& cheap_;
    std::shared_ptr<const Prediction> cheap_at_;
    std::vector<Eigen::VectorXd> shift_;  ///< [num_row] of each block
};

}  // namespace palpate
