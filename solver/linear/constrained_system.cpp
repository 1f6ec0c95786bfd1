// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/constrained_system.hpp"

#include <cmath>
#include <utility>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr Index nodes_per_thread = 500;

std::vector<unsigned char> nonzero_nodes(const Columns& x) {
    std::vector<unsigned char> nonzero(x.rows() / 3);
    for (std::size_t n = 0; n < nonzero.size(); ++n)
        nonzero[n] = !x.middleRows<3>(3 * static_cast<Index>(n)).isZero(0);
    return nonzero;
}

StiffnessMatrix checked_stiffness(const Model& model) {
    check_model(model);
    return assemble_stiffness(model);
}

}  // namespace

ConstrainedMatrix::ConstrainedMatrix(StiffnessMatrix stiffness,
                                     std::vector<std::uint8_t> prescribed)
    : stiffness_(std::move(stiffness)), prescribed_(std::move(prescribed)) {
    if (static_cast<Index>(prescribed_.size()) != 3 * stiffness_.num_nodes())
        throw Error(ErrorCode::invalid_argument,
                    "a matrix of " + std::to_string(stiffness_.num_nodes()) +
                        " nodes needs three marks of prescribed displacement per node, not " +
                        std::to_string(prescribed_.size()) + " in all");
}

ConstrainedSystem::ConstrainedSystem(const Model& model)
    : ConstrainedMatrix(checked_stiffness(model), model.prescribed), model_(model) {}

void ConstrainedSystem::set_stiffness(std::span<const double> stiffness_kpa) {
    if (stiffness_kpa.size() != model_.materials.size())
        throw Error(ErrorCode::invalid_argument,
                    "The linear solver got " + std::to_string(stiffness_kpa.size()) +
                        " moduli for " + std::to_string(model_.materials.size()) +
                        " materials; give one per material.");
    for (std::size_t r = 0; r < stiffness_kpa.size(); ++r) {
        if (!(stiffness_kpa[r] > 0) || !std::isfinite(stiffness_kpa[r]))
            throw Error(ErrorCode::invalid_argument,
                        "The linear solver got the modulus " + std::to_string(stiffness_kpa[r]) +
                            " kPa for region " + std::to_string(r) + "; it must be above 0.");
        model_.materials[r].stiffness_kpa = stiffness_kpa[r];
    }
    stiffness_ = assemble_stiffness(model_);
}

void ConstrainedMatrix::residual_rows(Index first, Index last, const Columns& b, const Columns& x,
                                      std::span<const unsigned char> nonzero, Columns& r) const {
    const Index columns = static_cast<Index>(x.cols());
    multiply_rows(stiffness_, first, last, x.data(), columns, nonzero, r.row(3 * first).data());
    for (Index d = 3 * first; d < 3 * last; ++d) {
        if (is_prescribed(d))
            r.row(d).setZero();
        else
            r.row(d) = b.row(d) - r.row(d);
    }
}

void ConstrainedMatrix::residual(const Columns& b, const Columns& x, Columns& r) const {
    r.resize(x.rows(), x.cols());
    residual_rows(0, stiffness_.num_nodes(), b, x, nonzero_nodes(x), r);
}

void ConstrainedMatrix::parallel_residual(const Columns& b, const Columns& x, Columns& r) const {
    r.resize(x.rows(), x.cols());
    const std::vector<unsigned char> nonzero = nonzero_nodes(x);
    parallel_ranges(stiffness_.num_nodes(), nodes_per_thread,
                    [&](Index first, Index last) { residual_rows(first, last, b, x, nonzero, r); });
}

std::vector<double> finite_norms(const Columns& columns, const std::string& what) {
    Eigen::RowVectorXd norms = Eigen::RowVectorXd::Zero(columns.cols());
    for (Eigen::Index row = 0; row < columns.rows(); ++row) norms += columns.row(row).cwiseAbs2();
    norms = norms.cwiseSqrt().eval();
    for (Eigen::Index c = 0; c < norms.size(); ++c)
        if (!std::isfinite(norms[c]))
            throw Error(ErrorCode::solve_failed,
                        "The " + what + " of column " + std::to_string(c) +
                            " of a linear solve is not a finite number; check the forces, the "
                            "displacements and the stiffness values that went in.");
    return {norms.begin(), norms.end()};
}

}  // namespace palpate
