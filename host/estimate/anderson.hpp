// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>

namespace palpate {

/// Anderson acceleration of a fixed-point iteration z -> z + f(z) (Walker and Ni 2011, algorithm
/// AA): of the last few steps it takes the combination that makes f smallest. Gauss-Newton leaves
/// out the curvature of the surfaces, so a handful of sliding motions converge slowly or swing to
/// and fro; this resolves them.
class AndersonAcceleration {
public:
    explicit AndersonAcceleration(int memory) : memory_(memory) {}

    /// The next iterate after z with step f; plain z + f while there is no history.
    Eigen::VectorXd next(const Eigen::VectorXd& z, const Eigen::VectorXd& f);
    /// Forgets the history, after the iteration itself has changed.
    void reset();
    bool has_history() const { return !step_changes_.empty(); }

private:
    int memory_;
    Eigen::VectorXd last_z_, last_f_;
    std::deque<Eigen::VectorXd> point_changes_, step_changes_;
};

}  // namespace palpate
