// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "solver/equilibrium/element_points.hpp"

namespace palpate {

/// The mean dilatation of small strains (B-bar, Hughes 1980): every point has the mean trace of its
/// element, H' = H + (mean tr H - tr H) I / 3, so that the law stays linear in the displacement.
/// The stress on H is P' with its mean pressure replaced by the element's.
template <class Law>
class MeanTrace {
public:
    /// `law_at(q)`: the law of point q.
    template <class LawAt>
    MeanTrace(const LawAt& law_at, const ElementPoints& element, const Eigen::VectorXd& u)
        : element_(element), count_(element.geometry.size()) {
        for (std::size_t q = 0; q < count_; ++q)
            h_[q] = displacement_gradient(element, element.geometry[q], u);
        give_mean_trace(h_);
        for (std::size_t q = 0; q < count_; ++q) {
            laws_[q].emplace(law_at(q));
            states_[q] = laws_[q]->state(h_[q]);
        }
    }

    bool is_valid() const {
        for (std::size_t q = 0; q < count_; ++q)
            if (!states_[q]->is_valid) return false;
        return true;
    }
    double energy() const {
        double sum = 0;
        for (std::size_t q = 0; q < count_; ++q)
            sum += element_.geometry[q].volume * laws_[q]->energy(*states_[q]);
        return sum;
    }
    void stress(PointTensors& p) const {
        for (std::size_t q = 0; q < count_; ++q) p[q] = laws_[q]->stress(*states_[q]);
        give_mean_trace(p);
    }
    void tangent_apply(const PointTensors& dh, PointTensors& dp) const {
        PointTensors given = dh;
        give_mean_trace(given);
        for (std::size_t q = 0; q < count_; ++q)
            dp[q] = laws_[q]->tangent_apply(*states_[q], given[q]);
        give_mean_trace(dp);
    }
    void law_directions(const PointTensors& dh, PointTensors& given) const {
        given = dh;
        give_mean_trace(given);
    }
    void pull_back(PointTensors& p) const { give_mean_trace(p); }
    Tensor3<double> held_direction(std::size_t, const Tensor3<double>&) const { return {}; }

    const Law& law(std::size_t q) const { return *laws_[q]; }
    const auto& state(std::size_t q) const { return *states_[q]; }
    const Tensor3<double>& gradient(std::size_t q) const { return h_[q]; }

private:
    /// A symmetric projection in the inner product of the volumes: it serves H and P alike.
    void give_mean_trace(PointTensors& tensors) const {
        double sum = 0, volume = 0;
        for (std::size_t q = 0; q < count_; ++q) {
            sum += element_.geometry[q].volume * trace(tensors[q]);
            volume += element_.geometry[q].volume;
        }
        for (std::size_t q = 0; q < count_; ++q)
            add_diagonal(tensors[q], (sum / volume - trace(tensors[q])) / 3);
    }

    const ElementPoints& element_;
    std::size_t count_;
    PointTensors h_;
    std::array<std::optional<Law>, most_element_points> laws_;
    std::array<std::optional<typename Law::State>, most_element_points> states_;
};

}  // namespace palpate
