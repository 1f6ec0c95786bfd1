// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include "host/estimate/block_covariance.hpp"
#include "host/estimate/data_problem.hpp"
#include "host/estimate/discrepancy.hpp"

namespace palpate {

struct NoiseOptions {
    /// A row whose independent noise is larger than this many sd counts less (Huber 1964).
    /// Infinite: all rows count alike.
    double huber_sd = 3;
    /// Modes of a discrepancy; what they miss counts as independent noise. Time and memory grow
    /// with it: rows * rank^2 operations where rows are no full grid.
    Index max_rank = 256;
};

/// What data leave between measured and predicted, block by block: independent noise with Huber
/// weights, and the model discrepancy. A copy is cheap and shares what is expensive.
class NoiseModel {
public:
    /// Without any discrepancy and with weights of 1. Coordinates of rows are taken from `blocks`.
    NoiseModel(const std::vector<DataBlock>& blocks, const NoiseOptions& options);

    Index num_block() const { return static_cast<Index>(blocks_.size()); }
    const NoiseOptions& options() const { return options_; }
    const RowGrid& grid(Index block) const { return *blocks_.at(block).grid; }
    const Discrepancy& discrepancy(Index block) const { return blocks_.at(block).field; }
    const Eigen::VectorXd& weights(Index block) const { return blocks_.at(block).weights; }
    const BlockCovariance& covariance(Index block) const { return *blocks_.at(block).covariance; }

    void set_discrepancy(Index block, const Discrepancy& discrepancy);
    /// Sets the weights w = min(1, huber_sd / |e / sd|) of the independent part e of the residuals,
    /// repeated until they hold still. Together with a step of the parameters each such update
    /// lowers `misfit`.
    void reweight(const Prediction& prediction);

    /// Sum over blocks of r^T C^-1 r / 2 + sum_i huber_sd^2 (1 / w_i - 1) / 2. After `reweight`
    /// this is Huber's function of the independent noise, plus the discrepancy's part.
    double misfit(const Prediction& prediction) const;
    /// Sum of ln det(2 pi C) / 2, the weights' own part left out: with `misfit` minus the log
    /// likelihood.
    double normalisation() const;

private:
    struct Block {
        std::shared_ptr<const RowGrid> grid;
        std::shared_ptr<const DiscrepancyBasis> basis;
        std::shared_ptr<const BlockCovariance> covariance;
        Discrepancy field;
        Eigen::VectorXd sd, weights;
        bool is_robust = true;
    };
    void factor(Block& block) const;
    double reweight_once(Block& block, const Eigen::VectorXd& residual) const;

    NoiseOptions options_;
    std::vector<Block> blocks_;
};

/// Measured less predicted, [num_row].
Eigen::VectorXd residual_of(const DataBlock& block);

/// Minus the log posterior F around a prediction with columns, on the transformed scale, C held.
/// Parameters k that are held learn nothing from the data (a cut posterior; Plummer 2015), so that
/// with the others o
///     H_kk = P_k + H_ko H_oo^-1 H_ok,   g_k = H_ko H_oo^-1 g_o:
/// in H^-1 they have their prior's variance, the others what that makes of theirs, and a step
/// -H^-1 g leaves them where they are.
struct NormalEquations {
    Eigen::MatrixXd information;  ///< sum of J^T C^-1 J, the data's part of the curvature
    Eigen::MatrixXd hessian;      ///< with the priors' precisions
    Eigen::VectorXd gradient;     ///< dF/dt, priors included
};
NormalEquations normal_equations(const std::vector<Parameter>& parameters,
                                 const Prediction& prediction, const NoiseModel& noise);

/// Makes those of `equations` of parameters that are held what is said there.
void hold(const std::vector<Parameter>& parameters, NormalEquations& equations);

/// F at a prediction: misfit, normalisation and priors' energy.
double minus_log_posterior(const std::vector<Parameter>& parameters, const Prediction& prediction,
                           const NoiseModel& noise);

}  // namespace palpate
