// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "solver/equilibrium/element_points.hpp"
#include "solver/equilibrium/point_response.hpp"

namespace palpate {

/// The response of an element whose points know nothing of each other.
template <class PointResponse>
class Pointwise {
public:
    /// `law_at(q)`: the law of point q.
    template <class LawAt>
    Pointwise(const LawAt& law_at, const ElementPoints& element, const Eigen::VectorXd& u)
        : element_(element), count_(element.geometry.size()) {
        for (std::size_t q = 0; q < count_; ++q)
            points_[q].emplace(law_at(q), displacement_gradient(element, element.geometry[q], u));
    }

    bool is_valid() const {
        for (std::size_t q = 0; q < count_; ++q)
            if (!points_[q]->is_valid()) return false;
        return true;
    }
    double energy() const {
        double sum = 0;
        for (std::size_t q = 0; q < count_; ++q)
            sum += element_.geometry[q].volume * points_[q]->energy();
        return sum;
    }
    void stress(PointTensors& p) const {
        for (std::size_t q = 0; q < count_; ++q) p[q] = points_[q]->stress();
    }
    /// dP at one point.
    Tensor3<double> tangent_apply_at(std::size_t q, const Tensor3<double>& dh) const {
        return points_[q]->tangent_apply(dh);
    }
    /// dP for changes dH of the points' displacement gradients.
    void tangent_apply(const PointTensors& dh, PointTensors& dp) const {
        for (std::size_t q = 0; q < count_; ++q) dp[q] = points_[q]->tangent_apply(dh[q]);
    }
    void law_directions(const PointTensors& dh, PointTensors& given) const {
        for (std::size_t q = 0; q < count_; ++q) given[q] = points_[q]->law_direction(dh[q]);
    }
    void pull_back(PointTensors& p) const {
        for (std::size_t q = 0; q < count_; ++q) p[q] = points_[q]->pull_back(p[q]);
    }
    Tensor3<double> held_direction(std::size_t q, const Tensor3<double>& p) const {
        return points_[q]->held_direction(p);
    }

    const auto& law(std::size_t q) const { return points_[q]->law(); }
    const auto& state(std::size_t q) const { return points_[q]->state(); }
    const Tensor3<double>& gradient(std::size_t q) const { return points_[q]->gradient(); }

private:
    const ElementPoints& element_;
    std::size_t count_;
    std::array<std::optional<PointResponse>, most_element_points> points_;
};

/// Whether a response's H follows stresses that change while the given H stays
/// (`held_direction`).
template <class Response>
inline constexpr bool follows_held_stress = false;
template <class Law>
inline constexpr bool follows_held_stress<Pointwise<PlaneStressResponse<Law>>> = true;

}  // namespace palpate
