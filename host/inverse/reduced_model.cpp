// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/reduced_model.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

Eigen::MatrixXd gather_rows(const Eigen::MatrixXd& x, const std::vector<Index>& nodes) {
    Eigen::MatrixXd rows(3 * nodes.size(), x.cols());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        rows.middleRows<3>(3 * k) = x.middleRows<3>(3 * nodes[k]);
    }
    return rows;
}

void scatter_add_rows(const Eigen::MatrixXd& rows, const std::vector<Index>& nodes,
                      Eigen::MatrixXd& y) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        y.middleRows<3>(3 * nodes[k]) += rows.middleRows<3>(3 * k);
    }
}

}  // namespace

ReducedModel::ReducedModel(std::vector<CondensedRegion> regions, Index num_observed,
                           Index num_driven, std::vector<double> stiffness_kpa)
    : regions_(std::move(regions)),
      num_observed_(num_observed),
      num_driven_(num_driven),
      stiffness_kpa_(std::move(stiffness_kpa)) {}

bool ReducedModel::has_region(Index region) const {
    return std::any_of(regions_.begin(), regions_.end(),
                       [&](const auto& condensed) { return condensed.region == region; });
}

Eigen::MatrixXd ReducedModel::stiffness() const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(observed_dofs(), observed_dofs());
    for (const auto& region : regions_) {
        const double modulus = stiffness_kpa_[region.region];
        const auto& nodes = region.observed;
        for (std::size_t b = 0; b < nodes.size(); ++b) {
            for (std::size_t a = 0; a < nodes.size(); ++a) {
                sum.block<3, 3>(3 * nodes[a], 3 * nodes[b]) +=
                    modulus * region.observed_observed.block<3, 3>(3 * a, 3 * b);
            }
        }
    }
    return sum;
}

Eigen::MatrixXd ReducedModel::unit_coupling_times(const CondensedRegion& region,
                                                  const Eigen::MatrixXd& driven) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(observed_dofs(), driven.cols());
    scatter_add_rows(region.observed_driven * gather_rows(driven, region.driven), region.observed,
                     sum);
    return sum;
}

Eigen::MatrixXd ReducedModel::coupling_times(const Eigen::MatrixXd& driven) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(observed_dofs(), driven.cols());
    for (const auto& region : regions_) {
        if (region.driven.empty()) continue;
        sum += stiffness_kpa_[region.region] * unit_coupling_times(region, driven);
    }
    return sum;
}

Eigen::MatrixXd ReducedModel::transposed_coupling_times(const Eigen::MatrixXd& observed) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(driven_dofs(), observed.cols());
    for (const auto& region : regions_) {
        if (region.driven.empty()) continue;
        scatter_add_rows(stiffness_kpa_[region.region] * (region.observed_driven.transpose() *
                                                          gather_rows(observed, region.observed)),
                         region.driven, sum);
    }
    return sum;
}

Eigen::VectorXd ReducedModel::observed_displacement(const Eigen::VectorXd& driven) const {
    if (num_observed_ == 0) return {};
    return -cholesky(stiffness(), "stiffness of the observed nodes").solve(coupling_times(driven));
}

void ReducedModel::add_observed_product(const CondensedRegion& region, double scale,
                                        const Eigen::MatrixXd& x, Eigen::MatrixXd& y) const {
    const Eigen::MatrixXd part =
        scale * (region.observed_observed * gather_rows(x, region.observed));
    scatter_add_rows(part, region.observed, y);
}

Eigen::LLT<Eigen::MatrixXd> cholesky(const Eigen::MatrixXd& matrix, const char* what) {
    Eigen::LLT<Eigen::MatrixXd> factor(matrix);
    if (factor.info() != Eigen::Success) {
        throw Error(ErrorCode::solve_failed,
                    fmt::format("the {} is not positive definite ({} rows): the mesh or the moduli "
                                "are unusable; try another mesh size",
                                what, matrix.rows()));
    }
    return factor;
}

}  // namespace palpate
