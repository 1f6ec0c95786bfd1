// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/anderson.hpp"

#include <Eigen/QR>

namespace palpate {

Eigen::VectorXd AndersonAcceleration::next(const Eigen::VectorXd& z, const Eigen::VectorXd& f) {
    if (last_z_.size() == z.size()) {
        point_changes_.push_back(z - last_z_);
        step_changes_.push_back(f - last_f_);
        if (static_cast<int>(step_changes_.size()) > memory_) {
            point_changes_.pop_front();
            step_changes_.pop_front();
        }
    }
    last_z_ = z;
    last_f_ = f;
    if (step_changes_.empty()) return z + f;

    const auto columns = static_cast<Eigen::Index>(step_changes_.size());
    Eigen::MatrixXd steps(f.size(), columns), points(f.size(), columns);
    for (Eigen::Index k = 0; k < columns; ++k) {
        steps.col(k) = step_changes_[k];
        points.col(k) = point_changes_[k];
    }
    const Eigen::VectorXd weights = steps.colPivHouseholderQr().solve(f);
    return z + f - (points + steps) * weights;
}

void AndersonAcceleration::reset() {
    last_z_.resize(0);
    last_f_.resize(0);
    point_changes_.clear();
    step_changes_.clear();
}

}  // namespace palpate
