// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solver/linear/linear_solver.hpp"
#include "solver/model/stiffness_matrix.hpp"

namespace palpate {

/// K x = b with prescribed dofs for one symmetric K, on the host in fp64: what every solver's
/// answer is checked against.
class ConstrainedMatrix {
public:
    /// `prescribed` [3 num_nodes], 1 where the displacement is given. Throws
    /// Error(invalid_argument) if the two do not have the same size.
    ConstrainedMatrix(StiffnessMatrix stiffness, std::vector<std::uint8_t> prescribed);

    const StiffnessMatrix& stiffness() const { return stiffness_; }
    const std::vector<std::uint8_t>& prescribed() const { return prescribed_; }
    Index num_dofs() const { return static_cast<Index>(prescribed_.size()); }
    bool is_prescribed(Index dof) const { return prescribed_[dof] != 0; }

    /// r = b - K x at free dofs and 0 at prescribed dofs, where x holds the prescribed values.
    /// One thread; b, x, r: [num_dofs, columns]. Nodes where x is zero cost nothing.
    void residual(const Columns& b, const Columns& x, Columns& r) const;
    /// The same with the nodes shared among the host threads.
    void parallel_residual(const Columns& b, const Columns& x, Columns& r) const;

protected:
    StiffnessMatrix stiffness_;

private:
    void residual_rows(Index first, Index last, const Columns& b, const Columns& x,
                       std::span<const unsigned char> nonzero, Columns& r) const;

    std::vector<std::uint8_t> prescribed_;
};

/// The K of a linearly elastic model, for any moduli.
class ConstrainedSystem : public ConstrainedMatrix {
public:
    /// Copies the model. Throws Error(invalid_argument) as `check_model` does.
    explicit ConstrainedSystem(const Model& model);

    void set_stiffness(std::span<const double> stiffness_kpa);
    const Model& model() const { return model_; }

private:
    Model model_;
};

/// Euclidean norm of every column. Throws Error(solve_failed) naming `what` if one is not finite.
std::vector<double> finite_norms(const Columns& columns, const std::string& what);

}  // namespace palpate
