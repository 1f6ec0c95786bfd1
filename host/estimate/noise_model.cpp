// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/noise_model.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Updates of the weights after one step; more gain nothing, since steps and updates alternate.
constexpr int max_reweighting = 5;
/// Weights hold still when none changes by more than this.
constexpr double weight_tolerance = 1e-3;

/// ln of (2 pi)^(1/2).
const double log_root_two_pi = 0.5 * std::log(2.0 * std::numbers::pi);

const DataBlock& block_of(const Prediction& prediction, Index b, Index num_block) {
    if (static_cast<Index>(prediction.blocks.size()) != num_block)
        throw Error(ErrorCode::internal,
                    "a prediction has other blocks of data than the first one");
    return prediction.blocks[b];
}

}  // namespace

Eigen::VectorXd residual_of(const DataBlock& block) { return block.measured - block.predicted; }

NoiseModel::NoiseModel(const std::vector<DataBlock>& blocks, const NoiseOptions& options)
    : options_(options) {
    for (const DataBlock& data : blocks) {
        Block block;
        block.grid = std::make_shared<const RowGrid>(data);
        block.sd = data.sd;
        block.weights = Eigen::VectorXd::Ones(data.num_row());
        block.is_robust = data.is_robust && std::isfinite(options.huber_sd);
        factor(block);
        blocks_.push_back(std::move(block));
    }
}

void NoiseModel::factor(Block& block) const {
    block.covariance = std::make_shared<const BlockCovariance>(
        block.sd.cwiseAbs2().cwiseQuotient(block.weights), block.field.amplitude, block.basis);
}

void NoiseModel::set_discrepancy(Index b, const Discrepancy& discrepancy) {
    Block& block = blocks_.at(b);
    const bool is_elsewhere = discrepancy.length_mm != block.field.length_mm ||
                              discrepancy.length_s != block.field.length_s;
    if (discrepancy.amplitude > 0 && (!block.basis || is_elsewhere))
        block.basis = std::make_shared<const DiscrepancyBasis>(
            block.grid->basis(discrepancy.length_mm, discrepancy.length_s, options_.max_rank));
    block.field = discrepancy;
    factor(block);
}

/// One update of the weights; gives the largest change.
double NoiseModel::reweight_once(Block& block, const Eigen::VectorXd& residual) const {
    const Eigen::VectorXd noise = block.covariance->independent_part(residual);
    // w = min(1, k / |e / sd|)
    const Eigen::VectorXd weights =
        (options_.huber_sd * block.sd.cwiseQuotient(noise.cwiseAbs())).cwiseMin(1.0);
    const double change = (weights - block.weights).lpNorm<Eigen::Infinity>();
    if (change == 0) return 0;
    block.weights = weights;
    factor(block);
    return change;
}

void NoiseModel::reweight(const Prediction& prediction) {
    for (Index b = 0; b < num_block(); ++b) {
        if (!blocks_[b].is_robust) continue;
        const Eigen::VectorXd residual = residual_of(block_of(prediction, b, num_block()));
        for (int round = 0; round < max_reweighting; ++round)
            if (reweight_once(blocks_[b], residual) < weight_tolerance) break;
    }
}

double NoiseModel::misfit(const Prediction& prediction) const {
    double sum = 0;
    for (Index b = 0; b < num_block(); ++b) {
        const Block& block = blocks_[b];
        const Eigen::VectorXd residual = residual_of(block_of(prediction, b, num_block()));
        sum += 0.5 * residual.dot(block.covariance->solve(residual).col(0));
        // rho(e) = min over w of w e^2 / 2 + k^2 (1 / w - 1) / 2
        if (block.is_robust)
            sum += 0.5 * options_.huber_sd * options_.huber_sd *
                   (block.weights.cwiseInverse().array() - 1.0).sum();
    }
    return sum;
}

double NoiseModel::normalisation() const {
    double sum = 0;
    for (const Block& block : blocks_)
        sum += 0.5 * block.covariance->log_determinant() + 0.5 * block.weights.array().log().sum() +
               log_root_two_pi * static_cast<double>(block.sd.size());
    return sum;
}

NormalEquations normal_equations(const std::vector<Parameter>& parameters,
                                 const Prediction& prediction, const NoiseModel& noise) {
    const auto count = static_cast<Index>(parameters.size());
    const Eigen::VectorXd transformed = to_transformed(parameters, prediction.values);
    const Eigen::VectorXd slopes = slopes_of(parameters, transformed);
    const TransformedPriors priors = priors_of(parameters);
    NormalEquations equations;
    equations.information = Eigen::MatrixXd::Zero(count, count);
    equations.gradient = priors.precision.cwiseProduct(transformed - priors.mean);
    for (Index b = 0; b < noise.num_block(); ++b) {
        const DataBlock& block = block_of(prediction, b, noise.num_block());
        const Eigen::MatrixXd columns = transformed_columns(block, slopes);
        const Eigen::MatrixXd weighted = noise.covariance(b).solve(columns);
        equations.information += columns.transpose() * weighted;          // J^T C^-1 J
        equations.gradient -= weighted.transpose() * residual_of(block);  // -J^T C^-1 r
    }
    equations.information =
        0.5 * (equations.information + equations.information.transpose()).eval();
    equations.hessian = equations.information;
    equations.hessian.diagonal() += priors.precision;
    hold(parameters, equations);
    return equations;
}

void hold(const std::vector<Parameter>& parameters, NormalEquations& equations) {
    const std::vector<Index> held = held_of(parameters);
    if (held.empty()) return;
    std::vector<Index> others;
    for (std::size_t k = 0; k < parameters.size(); ++k)
        if (!parameters[k].is_held) others.push_back(static_cast<Index>(k));
    const Eigen::MatrixXd coupling = equations.hessian(others, held);
    // H_oo^-1 (H_ok, g_o)
    const Eigen::LDLT<Eigen::MatrixXd> factor(Eigen::MatrixXd(equations.hessian(others, others)));
    const Eigen::MatrixXd follow = factor.solve(coupling);
    const Eigen::MatrixXd seen = coupling.transpose() * follow;
    const Eigen::VectorXd pull = equations.gradient(others);
    equations.gradient(held) = follow.transpose() * pull;
    equations.information(held, held) = seen;
    equations.hessian(held, held) = seen;
    const TransformedPriors priors = priors_of(parameters);
    for (const Index k : held) equations.hessian(k, k) += priors.precision[k];
}

double minus_log_posterior(const std::vector<Parameter>& parameters, const Prediction& prediction,
                           const NoiseModel& noise) {
    const TransformedPriors priors = priors_of(parameters);
    double sum = noise.misfit(prediction) + noise.normalisation() +
                 priors.energy(to_transformed(parameters, prediction.values));
    for (const Parameter& parameter : parameters)
        if (parameter.has_prior()) sum += std::log(parameter.sd) + log_root_two_pi;
    return sum;
}

}  // namespace palpate
