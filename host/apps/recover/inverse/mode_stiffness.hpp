// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <utility>

namespace palpate {

/// S(E) of a response model [modes, modes], mN/mm: factorised, or diagonal.
class ModeStiffness {
public:
    ModeStiffness() = default;
    explicit ModeStiffness(const Eigen::MatrixXd& dense) : dense_(dense) {}
    explicit ModeStiffness(Eigen::VectorXd diagonal) : diagonal_(std::move(diagonal)) {}

    /// Whether every mode resists; nothing can be solved otherwise.
    bool is_definite() const {
        if (diagonal_.size() > 0) return (diagonal_.array() > 0).all();
        return dense_.info() == Eigen::Success;
    }
    /// S^-1 f for columns f [modes, any].
    void solve_in_place(Eigen::MatrixXd& forces) const {
        if (diagonal_.size() == 0) return dense_.solveInPlace(forces);
        forces.array().colwise() /= diagonal_.array();
    }
    Eigen::MatrixXd solve(Eigen::MatrixXd forces) const {
        solve_in_place(forces);
        return forces;
    }

private:
    Eigen::VectorXd diagonal_;
    Eigen::LLT<Eigen::MatrixXd> dense_;
};

}  // namespace palpate
