// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/sensitivity/held_body.hpp"

#include <utility>

#include "solver/base/error.hpp"

namespace palpate {

HeldBody::HeldBody(std::shared_ptr<const SolidModel> model)
    : model_(std::move(model)),
      solid_(*model_),
      contact_(*model_),
      pressure_(*model_),
      history_(*model_) {}

HeldBody::Push HeldBody::advance(double time_s, const Eigen::VectorXd& u, const SolidLoads& loads) {
    const double dt_s = time_s - time_s_;
    if (has_relaxation(*model_)) history_.begin_step(dt_s, solid_);
    contact_.begin(start_);
    contact_.place(loads.obstacle_motion);
    contact_.renew_limits(u);
    pressure_.set(loads.pressure_kpa);
    InternalForce inner = solid_.internal_force(u);
    if (!inner.is_valid)
        throw Error(ErrorCode::solve_failed,
                    "matter inverts where a body of nearly the same shape is in equilibrium");
    contact_.add_force(u, inner);
    pressure_.add_force(u, inner);
    ContactState touched = contact_.state(u);
    if (has_relaxation(*model_)) history_.end_step(dt_s, solid_, u);
    start_ = {u, loads.obstacle_motion, std::move(touched.friction)};
    time_s_ = time_s;
    return {std::move(inner.force), std::move(touched.force)};
}

}  // namespace palpate
