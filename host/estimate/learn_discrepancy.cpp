// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/learn_discrepancy.hpp"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "host/estimate/robust_spread.hpp"
#include "host/estimate/trust_region.hpp"

namespace palpate {
namespace {

constexpr Index max_learning_rows = 2500;
constexpr Index max_learning_rank = 200;
/// Step of ln s and ln length for second derivatives.
constexpr double curvature_step = 0.15;

/// The variances of the independent noise with which a block takes part in the learning, [num_row].
Eigen::VectorXd learning_variances(const DataBlock& block, const BlockCovariance& covariance,
                                   double huber_sd) {
    Eigen::VectorXd variances = block.sd.cwiseAbs2();
    if (!block.is_robust || !std::isfinite(huber_sd)) return variances;
    const Eigen::VectorXd noise = covariance.independent_part(residual_of(block)).cwiseAbs();
    const Eigen::VectorXd ratio = noise.cwiseQuotient(block.sd);
    const double limit = huber_sd * std::max(1.0, sd_over_mad * middle_of(ratio));
    for (Index i = 0; i < block.num_row(); ++i)
        if (ratio[i] > limit) variances[i] = noise[i] * noise[i];
    return variances;
}

/// What all data but one block, and the priors, say of the parameters: the data are
/// exp(-(d^T precision d) / 2 + d^T pull) in a change d of the transformed parameters.
struct OtherEvidence {
    Eigen::MatrixXd precision;
    Eigen::VectorXd pull;
};

/// -ln p of one block's discrepancy, the parameters integrated out.
class BlockLikelihood {
public:
    BlockLikelihood(DataBlock rows, OtherEvidence others, DiscrepancyRange range)
        : rows_(std::move(rows)),
          others_(std::move(others)),
          range_(std::move(range)),
          grid_(rows_),
          residual_and_columns_(rows_.num_row(), 1 + rows_.columns.cols()) {
        residual_and_columns_ << residual_of(rows_), rows_.columns;
    }

    double operator()(const Discrepancy& field);

private:
    DataBlock rows_;
    OtherEvidence others_;
    DiscrepancyRange range_;
    RowGrid grid_;
    Eigen::MatrixXd residual_and_columns_;
    std::shared_ptr<const DiscrepancyBasis> basis_;
    double basis_mm_ = 0, basis_s_ = 0;  ///< lengths of `basis_`
};

double BlockLikelihood::operator()(const Discrepancy& field) {
    if (!basis_ || field.length_mm != basis_mm_ || field.length_s != basis_s_) {
        basis_ = std::make_shared<const DiscrepancyBasis>(
            grid_.basis(field.length_mm, field.length_s, max_learning_rank));
        basis_mm_ = field.length_mm;
        basis_s_ = field.length_s;
    }
    const BlockCovariance covariance(rows_.sd.cwiseAbs2(), field.amplitude, basis_);
    // [r J]^T C^-1 [r J] has all three products.
    const Eigen::MatrixXd products =
        residual_and_columns_.transpose() * covariance.solve(residual_and_columns_);
    const Index count = static_cast<Index>(rows_.columns.cols());
    const Eigen::MatrixXd precision = others_.precision + products.bottomRightCorner(count, count);
    const Eigen::VectorXd pull = others_.pull + products.col(0).tail(count);
    const Eigen::LDLT<Eigen::MatrixXd> factor(precision);
    // Directions that nothing knows have the same, negligible, weight whatever the discrepancy.
    const double floor = 1e-14 * std::max(precision.diagonal().maxCoeff(), 1e-300);
    const double log_determinant = factor.vectorD().array().max(floor).log().sum();
    const double quadratic = products(0, 0) - pull.dot(factor.solve(pull));
    return 0.5 * (covariance.log_determinant() + log_determinant + quadratic) -
           log_prior(range_, field);
}

/// The unknowns of a discrepancy as numbers from 0 to 1 between the hard ends of their logarithms.
class DiscrepancyCoordinates {
public:
    explicit DiscrepancyCoordinates(const DiscrepancyRange& range) {
        add(range.amplitude, &Discrepancy::amplitude);
        add(range.length_mm, &Discrepancy::length_mm);
        add(range.length_s, &Discrepancy::length_s);
        fixed_.length_mm = range.length_mm[0];
        fixed_.length_s = range.length_s[0];
    }
    Discrepancy field(const Eigen::VectorXd& x) const {
        Discrepancy field = fixed_;
        for (std::size_t k = 0; k < members_.size(); ++k)
            field.*members_[k] = std::exp(low_[k] + x[static_cast<Index>(k)] * width_[k]);
        return field;
    }
    std::size_t count() const { return members_.size(); }
    double Discrepancy::*member(std::size_t k) const { return members_[k]; }
    /// Whether a step of ln away from `x` on both sides is within the ends.
    bool is_inside(const Eigen::VectorXd& x, std::size_t k, double step) const {
        const double share = step / width_[k], at = x[static_cast<Index>(k)];
        return at > share && at < 1.0 - share;
    }
    Eigen::VectorXd coordinates(const Discrepancy& field) const {
        Eigen::VectorXd x(members_.size());
        for (std::size_t k = 0; k < members_.size(); ++k)
            x[static_cast<Index>(k)] = std::clamp(
                (std::log(std::max(field.*members_[k], 1e-300)) - low_[k]) / width_[k], 0.0, 1.0);
        return x;
    }

private:
    void add(const std::array<double, 2>& ends, double Discrepancy::*member) {
        if (!(ends[1] > ends[0])) return;
        members_.push_back(member);
        low_.push_back(std::log(ends[0]));
        width_.push_back(std::log(ends[1] / ends[0]));
    }
    std::vector<double Discrepancy::*> members_;
    std::vector<double> low_, width_;
    Discrepancy fixed_;
};

/// Where a search for a discrepancy begins: the best of some amplitudes at the prior's lengths, or
/// at those of `last`, or `last` itself.
Discrepancy best_start(BlockLikelihood& likelihood, const DiscrepancyRange& range,
                       const Discrepancy& last) {
    constexpr int num_amplitude = 6;
    const DiscrepancyCoordinates coordinates(range);
    Discrepancy best = last;
    double lowest = std::numeric_limits<double>::infinity();
    const auto look = [&](const Discrepancy& field) {
        const double value = likelihood(field);
        if (!(value < lowest)) return;
        lowest = value;
        best = field;
    };
    if (last.amplitude > 0) look(coordinates.field(coordinates.coordinates(last)));
    for (int k = 0; k < num_amplitude; ++k) {
        const double share = (k + 0.5) / num_amplitude;
        look({range.amplitude[0] * std::pow(range.amplitude[1] / range.amplitude[0], share),
              range.typical_mm, range.typical_s});
    }
    return best;
}

Discrepancy learn_block(BlockLikelihood& likelihood, const DiscrepancyRange& range,
                        const Discrepancy& last, const ProgressSink& progress) {
    const DiscrepancyCoordinates coordinates(range);
    const NloptOptions options{0, 1, 0.1, 3e-3, 120};
    const auto value_at = [&](const Eigen::VectorXd& x) {
        check_cancelled(progress);
        return likelihood(coordinates.field(x));
    };
    const Eigen::VectorXd start = coordinates.coordinates(best_start(likelihood, range, last));
    const NloptMinimum found = minimise_in_trust_region(value_at, start, options);
    // The search begins a step away from the ends.
    return coordinates.field(value_at(start) < found.value ? start : found.x);
}

/// Inverse of the curvature of -ln p in ln s, ln length_mm, ln length_s; those that are known or at
/// a hard end have no variance. Of s, which is not known better for a bound, it is taken a step
/// within its upper end.
Eigen::Matrix3d log_covariance(BlockLikelihood& likelihood, const DiscrepancyRange& range,
                               Discrepancy at) {
    const DiscrepancyCoordinates coordinates(range);
    constexpr double within = 1.01 * curvature_step;
    at.amplitude = std::min(at.amplitude, range.amplitude[1] * std::exp(-within));
    const Eigen::VectorXd x = coordinates.coordinates(at);
    std::vector<int> places;  // of the coordinates that have room, in (s, mm, s)
    std::vector<double Discrepancy::*> members;
    for (std::size_t k = 0; k < coordinates.count(); ++k) {
        if (!coordinates.is_inside(x, k, curvature_step)) continue;
        members.push_back(coordinates.member(k));
        places.push_back(members.back() == &Discrepancy::amplitude   ? 0
                         : members.back() == &Discrepancy::length_mm ? 1
                                                                     : 2);
    }
    const auto value = [&](std::size_t i, double up_i, std::size_t j, double up_j) {
        Discrepancy field = at;
        field.*members[i] *= std::exp(up_i * curvature_step);
        field.*members[j] *= std::exp(up_j * curvature_step);
        return likelihood(field);
    };
    const auto count = static_cast<Index>(members.size());
    if (count == 0) return Eigen::Matrix3d::Zero();
    Eigen::MatrixXd curvature(count, count);
    const double h2 = curvature_step * curvature_step;
    for (Index i = 0; i < count; ++i)
        for (Index j = 0; j <= i; ++j)
            // f_ij = (f(++) - f(+-) - f(-+) + f(--)) / (4 h^2); for i = j with half steps
            curvature(i, j) = curvature(j, i) =
                i == j ? (value(i, 1, i, 0) - 2 * value(i, 0, i, 0) + value(i, -1, i, 0)) / h2
                       : (value(i, 1, j, 1) - value(i, 1, j, -1) - value(i, -1, j, 1) +
                          value(i, -1, j, -1)) /
                             (4 * h2);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(curvature);
    // Nowhere is less known than by the weakest prior.
    const double least = 1.0 / (prior_sd_ln_amplitude * prior_sd_ln_amplitude);
    const Eigen::MatrixXd covariance =
        eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(least).cwiseInverse().asDiagonal() *
        eigen.eigenvectors().transpose();
    Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
    for (Index i = 0; i < count; ++i)
        for (Index j = 0; j < count; ++j) all(places[i], places[j]) = covariance(i, j);
    return all;
}

/// In which mean each row goes.
std::vector<Index> groups_of_rows(const RowGrid& grid, Index stride) {
    std::map<std::pair<int, int>, Index> numbers;
    std::vector<Index> groups;
    for (Index i = 0; i < grid.num_row(); ++i)
        groups.push_back(numbers
                             .try_emplace({grid.place_of_row()[i],
                                           grid.time_of_row()[i] / static_cast<int>(stride)},
                                          static_cast<Index>(numbers.size()))
                             .first->second);
    return groups;
}

/// Times at which means count: the middle of each group of `stride` times, the same for all places.
Eigen::VectorXd group_times(const DataBlock& block, const RowGrid& grid, Index stride) {
    const Index count = (grid.num_time() + stride - 1) / stride;
    Eigen::VectorXd first = Eigen::VectorXd::Constant(count, 1e300), last = -first;
    for (Index i = 0; i < block.num_row(); ++i) {
        const Index group = grid.time_of_row()[i] / stride;
        first[group] = std::min(first[group], block.time_s[i]);
        last[group] = std::max(last[group], block.time_s[i]);
    }
    return 0.5 * (first + last);
}

DataBlock averaged_block(const DataBlock& block, const RowGrid& grid, Index stride) {
    const std::vector<Index> groups = groups_of_rows(grid, stride);
    const Eigen::VectorXd times = group_times(block, grid, stride);
    const Index count = 1 + *std::max_element(groups.begin(), groups.end());
    DataBlock mean = block;
    Eigen::VectorXd precision = Eigen::VectorXd::Zero(count);
    mean.measured = mean.predicted = mean.time_s = precision;
    mean.columns = Eigen::MatrixXd::Zero(count, block.columns.cols());
    mean.position_mm.resize(count, block.position_mm.cols());
    for (Index i = 0; i < block.num_row(); ++i) {
        const Index g = groups[i];
        const double weight = 1.0 / (block.sd[i] * block.sd[i]);
        precision[g] += weight;
        mean.measured[g] += weight * block.measured[i];
        mean.predicted[g] += weight * block.predicted[i];
        mean.columns.row(g) += weight * block.columns.row(i);
        mean.time_s[g] = times[grid.time_of_row()[i] / stride];
        if (block.position_mm.cols() > 0) mean.position_mm.row(g) = block.position_mm.row(i);
    }
    mean.measured = mean.measured.cwiseQuotient(precision);
    mean.predicted = mean.predicted.cwiseQuotient(precision);
    mean.columns = precision.cwiseInverse().asDiagonal() * mean.columns;
    mean.sd = precision.cwiseSqrt().cwiseInverse();
    return mean;
}

DataBlock every_row(const DataBlock& block, Index stride) {
    std::vector<Index> rows;
    for (Index i = 0; i < block.num_row(); i += stride) rows.push_back(i);
    DataBlock some = block;
    some.measured = block.measured(rows);
    some.predicted = block.predicted(rows);
    some.sd = block.sd(rows);
    some.columns = block.columns(rows, Eigen::all);
    if (block.position_mm.size() > 0) some.position_mm = block.position_mm(rows, Eigen::all);
    if (block.time_s.size() > 0) some.time_s = block.time_s(rows);
    return some;
}

}  // namespace

DataBlock thinned_block(const DataBlock& block, Index max_rows) {
    const Index stride = (block.num_row() + max_rows - 1) / max_rows;
    if (stride <= 1) return block;
    const RowGrid grid(block);
    return grid.num_time() >= 4 * stride ? averaged_block(block, grid, stride)
                                         : every_row(block, stride);
}

namespace {

/// The likelihoods of the discrepancies of a prediction's blocks.
class PredictionLikelihoods {
public:
    PredictionLikelihoods(const std::vector<Parameter>& parameters, const Prediction& prediction,
                          const NoiseModel& noise)
        : prediction_(without_held(parameters, prediction)),
          noise_(noise),
          slopes_(slopes_of(parameters, to_transformed(parameters, prediction.values))),
          all_(normal_equations(parameters, prediction_, noise)),
          ranges_(discrepancy_ranges(parameters, prediction, noise)) {}

    bool is_learned(Index b) const {
        return prediction_.blocks[b].has_discrepancy && prediction_.blocks[b].num_row() > 0;
    }
    const DiscrepancyRange& range(Index b) const { return ranges_[b]; }
    BlockLikelihood of_block(Index b) const;

private:
    /// What is held does not follow the data, whatever these are taken to miss.
    static Prediction without_held(const std::vector<Parameter>& parameters,
                                   Prediction prediction) {
        for (const Index k : held_of(parameters))
            for (DataBlock& block : prediction.blocks) block.columns.col(k).setZero();
        return prediction;
    }

    const Prediction prediction_;
    const NoiseModel& noise_;
    Eigen::VectorXd slopes_;
    NormalEquations all_;
    std::vector<DiscrepancyRange> ranges_;
};

BlockLikelihood PredictionLikelihoods::of_block(Index b) const {
    DataBlock block = prediction_.blocks[b];
    block.columns = transformed_columns(block, slopes_);
    const Eigen::MatrixXd weighted = noise_.covariance(b).solve(block.columns);
    const OtherEvidence others{all_.hessian - block.columns.transpose() * weighted,
                               -all_.gradient - weighted.transpose() * residual_of(block)};
    block.sd =
        learning_variances(block, noise_.covariance(b), noise_.options().huber_sd).cwiseSqrt();
    return {thinned_block(block, max_learning_rows), others, range(b)};
}

}  // namespace

std::vector<Discrepancy> learn_discrepancies(const std::vector<Parameter>& parameters,
                                             const Prediction& prediction, const NoiseModel& noise,
                                             const ProgressSink& progress) {
    const PredictionLikelihoods likelihoods(parameters, prediction, noise);
    std::vector<Discrepancy> learned;
    for (Index b = 0; b < noise.num_block(); ++b) {
        learned.push_back(noise.discrepancy(b));
        if (!likelihoods.is_learned(b)) continue;
        report_progress(progress, "learning what the model misses", -1, prediction.blocks[b].name);
        BlockLikelihood likelihood = likelihoods.of_block(b);
        learned.back() = learn_block(likelihood, likelihoods.range(b), learned.back(), progress);
    }
    return learned;
}

std::vector<Eigen::Matrix3d> discrepancy_covariances(const std::vector<Parameter>& parameters,
                                                     const Prediction& prediction,
                                                     const NoiseModel& noise) {
    const PredictionLikelihoods likelihoods(parameters, prediction, noise);
    std::vector<Eigen::Matrix3d> covariances;
    for (Index b = 0; b < noise.num_block(); ++b) {
        covariances.emplace_back(Eigen::Matrix3d::Zero());
        if (!likelihoods.is_learned(b) || noise.discrepancy(b).amplitude <= 0) continue;
        BlockLikelihood likelihood = likelihoods.of_block(b);
        covariances.back() = log_covariance(likelihood, likelihoods.range(b), noise.discrepancy(b));
    }
    return covariances;
}

}  // namespace palpate
