// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/reduced_model.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Whether a list of distinct nodes in ascending order is 0, 1 .. count - 1.
bool is_every_node(const std::vector<Index>& nodes, Index count) {
    return static_cast<Index>(nodes.size()) == count;
}

Eigen::MatrixXd gathered_rows(const Eigen::MatrixXd& x, const std::vector<Index>& nodes) {
    Eigen::MatrixXd rows(3 * nodes.size(), x.cols());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        rows.middleRows<3>(3 * k) = x.middleRows<3>(3 * nodes[k]);
    }
    return rows;
}

Eigen::MatrixXd scattered_rows(Eigen::MatrixXd rows, const std::vector<Index>& nodes, Index count) {
    if (is_every_node(nodes, count)) return rows;
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(3 * count, rows.cols());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        y.middleRows<3>(3 * nodes[k]) = rows.middleRows<3>(3 * k);
    }
    return y;
}

/// matrix x[nodes]
template <typename Matrix>
Eigen::MatrixXd times_rows(const Matrix& matrix, const Eigen::MatrixXd& x,
                           const std::vector<Index>& nodes) {
    if (is_every_node(nodes, static_cast<Index>(x.rows() / 3))) return matrix * x;
    return matrix * gathered_rows(x, nodes);
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

Eigen::MatrixXd ReducedModel::stiffness(const std::vector<double>& kpa) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(observed_dofs(), observed_dofs());
    for (const auto& region : regions_) {
        // S_oo(E) = sum_r E_r S_r,oo (method.md, 1.3)
        const double modulus = kpa[region.region];
        const auto& nodes = region.observed;
        if (is_every_node(nodes, num_observed_)) {
            sum += modulus * region.observed_observed;
            continue;
        }
        for (std::size_t b = 0; b < nodes.size(); ++b) {
            for (std::size_t a = 0; a < nodes.size(); ++a) {
                sum.block<3, 3>(3 * nodes[a], 3 * nodes[b]) +=
                    modulus * region.observed_observed.block<3, 3>(3 * a, 3 * b);
            }
        }
    }
    return sum;
}

Eigen::MatrixXd ReducedModel::unit_stiffness_times(const CondensedRegion& region,
                                                   const Eigen::MatrixXd& x) const {
    return scattered_rows(times_rows(region.observed_observed, x, region.observed), region.observed,
                          num_observed_);
}

Eigen::MatrixXd ReducedModel::unit_coupling_times(const CondensedRegion& region,
                                                  const Eigen::MatrixXd& driven) const {
    return scattered_rows(times_rows(region.observed_driven, driven, region.driven),
                          region.observed, num_observed_);
}

Eigen::MatrixXd ReducedModel::coupling_times(const std::vector<double>& kpa,
                                             const Eigen::MatrixXd& driven) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(observed_dofs(), driven.cols());
    for (const auto& region : regions_) {
        if (region.driven.empty()) continue;
        // S_od(E) u_d
        sum += kpa[region.region] * unit_coupling_times(region, driven);
    }
    return sum;
}

Eigen::MatrixXd ReducedModel::transposed_coupling_times(const std::vector<double>& kpa,
                                                        const Eigen::MatrixXd& observed) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(driven_dofs(), observed.cols());
    for (const auto& region : regions_) {
        if (region.driven.empty()) continue;
        sum += kpa[region.region] * scattered_rows(times_rows(region.observed_driven.transpose(),
                                                              observed, region.observed),
                                                   region.driven, num_driven_);
    }
    return sum;
}

Eigen::VectorXd ReducedModel::observed_displacement(const std::vector<double>& kpa,
                                                    const Eigen::VectorXd& driven) const {
    if (num_observed_ == 0) return {};
    const auto equilibrium = cholesky(stiffness(kpa), "stiffness of the observed nodes");
    // u_o = -S_oo^-1 S_od u_d (method.md, 1.3)
    return -equilibrium.solve(coupling_times(kpa, driven));
}

void throw_indefinite(const char* what, Index rows) {
    throw Error(ErrorCode::solve_failed,
                fmt::format("the {} is not positive definite ({} rows): the mesh or the moduli "
                            "are unusable; try another mesh size",
                            what, rows));
}

Eigen::LLT<Eigen::MatrixXd> cholesky(const Eigen::MatrixXd& matrix, const char* what) {
    Eigen::LLT<Eigen::MatrixXd> factor(matrix);
    if (factor.info() != Eigen::Success) throw_indefinite(what, static_cast<Index>(matrix.rows()));
    return factor;
}

}  // namespace palpate
