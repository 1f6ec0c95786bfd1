// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <type_traits>

#include "solver/equilibrium/element_response.hpp"

// Derivatives of one element in a viscous step, for gradients through a load history.
namespace palpate {

template <class LawAt>
using LawOf = std::decay_t<decltype(std::declval<const LawAt&>()(std::size_t{0}))>;
template <class LawAt>
constexpr bool gives_viscous_step = is_viscous_step<LawOf<std::decay_t<LawAt>>>;

/// slope : S of every point as a stress on the law's H, per volume; S is what relaxes.
template <class Response>
void stress_slopes(const Response& response, const ElementPoints& element,
                   std::span<const Tensor3<double>> slope, PointTensors& stress) {
    for (std::size_t q = 0; q < element.geometry.size(); ++q) {
        const auto& law = response.law(q);
        const auto& state = response.state(q);
        stress[q] = law.relaxing_stress_slope(state, law.relaxing_at(state),
                                              scaled(slope[q], 1 / element.geometry[q].volume));
    }
}

/// Derivative by the element's displacements of the sum of slope : S, S the second Piola stress
/// that relaxes at each point.
template <class LawAt>
std::array<Vec3, most_element_nodes> element_stress_gradient(
    const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
    const Eigen::VectorXd& u, std::span<const Tensor3<double>> slope) {
    std::array<Vec3, most_element_nodes> gradient;
    gradient.fill(Vec3::Zero());
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) return;
        PointTensors stress;
        stress_slopes(response, element, slope, stress);
        response.pull_back(stress);
        for (std::size_t q = 0; q < element.geometry.size(); ++q)
            for (std::size_t a = 0; a < element.nodes.size(); ++a)
                gradient[a] +=
                    element.geometry[q].volume * force_on(stress[q], element.geometry[q], a);
    });
    return gradient;
}

/// Where `add_viscous_slopes` adds.
struct ElementViscousSlopes {
    std::span<Tensor3<double>> prestress;  ///< [points]
    double& factor;
    std::span<double> parameters;
};

/// Derivatives of direction . f + sum of slope : S at held displacements.
template <class LawAt>
void add_viscous_slopes(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                        const Eigen::VectorXd& u, const Eigen::VectorXd& direction,
                        std::span<const Tensor3<double>> slope, ElementViscousSlopes sums) {
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) return;
        PointTensors given{}, stress;
        for (std::size_t q = 0; q < element.geometry.size(); ++q)
            given[q] = displacement_gradient(element, element.geometry[q], direction);
        response.law_directions(given, given);
        stress_slopes(response, element, slope, stress);
        for (std::size_t q = 0; q < element.geometry.size(); ++q) {
            const double volume = element.geometry[q].volume;
            const auto& law = response.law(q);
            const auto& state = response.state(q);
            const auto on_stress =
                scaled(sum_of(1.0, given[q], 1.0, response.held_direction(q, stress[q])), volume);
            sums.prestress[q] =
                sum_of(1.0, sums.prestress[q], 1.0, law.prestress_slope(state, on_stress));
            // by the factor: the stress of what relaxes
            const auto relaxing = law.relaxing_at(state);
            sums.factor += double_dot(relaxing.stress, on_stress);
            // slope : dS = F^-T slope : dP of what relaxes
            const auto on_relaxing =
                inverse_transposed_times<LawOf<LawAt>::small_strain>(state.h, slope[q]);
            for (std::size_t k = 0; k < sums.parameters.size(); ++k) {
                const int parameter = static_cast<int>(k);
                sums.parameters[k] +=
                    double_dot(law.parameter_stress(state, parameter), on_stress) +
                    double_dot(law.relaxing_parameter_stress(relaxing, parameter), on_relaxing);
            }
        }
    });
}

}  // namespace palpate
