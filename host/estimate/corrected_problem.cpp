// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/corrected_problem.hpp"

#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct CorrectedPrediction : Prediction {
    std::shared_ptr<const Prediction> cheap;
};

}  // namespace

CorrectedProblem::CorrectedProblem(const DataProblem& cheap, const Prediction& exact_at,
                                   std::shared_ptr<const Prediction> cheap_at)
    : cheap_(cheap), cheap_at_(std::move(cheap_at)) {
    bool is_alike =
        exact_at.values == cheap_at_->values && exact_at.blocks.size() == cheap_at_->blocks.size();
    for (std::size_t b = 0; is_alike && b < exact_at.blocks.size(); ++b) {
        const Eigen::VectorXd &exact = exact_at.blocks[b].predicted,
                              &own = cheap_at_->blocks[b].predicted;
        is_alike = exact.size() == own.size();
        if (is_alike) shift_.push_back(exact - own);
    }
    if (!is_alike)
        throw Error(ErrorCode::invalid_argument,
                    "a model is corrected by another one's prediction of the same rows at the same "
                    "values");
}

PredictionAttempt CorrectedProblem::predict(const Eigen::VectorXd& values, PredictedColumns columns,
                                            const Prediction* warm) const {
    const auto* earlier = dynamic_cast<const CorrectedPrediction*>(warm);
    PredictionAttempt made =
        cheap_.predict(values, columns, earlier ? earlier->cheap.get() : cheap_at_.get());
    if (!made.prediction) return made;
    auto corrected = std::make_shared<CorrectedPrediction>();
    static_cast<Prediction&>(*corrected) = *made.prediction;
    for (std::size_t b = 0; b < shift_.size(); ++b) corrected->blocks[b].predicted += shift_[b];
    corrected->cheap = std::move(made.prediction);
    made.prediction = std::move(corrected);
    return made;
}

std::shared_ptr<const Prediction> CorrectedProblem::cheap_of(const Prediction& prediction) {
    const auto* corrected = dynamic_cast<const CorrectedPrediction*>(solved_of(&prediction));
    return corrected ? corrected->cheap : nullptr;
}

}  // namespace palpate
