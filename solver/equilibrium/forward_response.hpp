// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "solver/equilibrium/viscous_response.hpp"

// Changes of one element with what its laws and its viscous step are made of, for forward columns.
namespace palpate {

/// A direction in what the stress of an element, or of some side by side, is made of, per unit of
/// one parameter.
template <typename Real>
struct ChangeOf {
    std::span<const double> parameters;             ///< [parameters] of the law
    double factor = 0;                              ///< of the viscous step
    std::span<const Tensor3<Real>> prestress = {};  ///< [points] kPa; empty: none
};
using ElementChange = ChangeOf<double>;

/// What of a point serves all changes: what relaxes, if anything does.
template <class Law>
auto relaxing_at(const Law& law, const typename Law::State& state) {
    if constexpr (is_viscous_step<Law>)
        return law.relaxing_at(state);
    else
        return std::monostate{};
}

/// dP at point q while H stays, of a law or a viscous step.
template <class Law, class Relaxing>
Tensor3<typename Law::Number> held_stress_change(const Law& law, const typename Law::State& state,
                                                 const Relaxing& relaxing, std::size_t q,
                                                 const ChangeOf<typename Law::Number>& change) {
    Tensor3<typename Law::Number> sum{};
    for (std::size_t k = 0; k < change.parameters.size(); ++k)
        // dP = dP/dp_k dp_k + P of what relaxes dfactor + F dQ
        if (change.parameters[k] != 0)
            sum = sum_of(1.0, sum, change.parameters[k],
                         law.parameter_stress(state, static_cast<int>(k)));
    if constexpr (is_viscous_step<Law>) {
        if (change.factor != 0) sum = sum_of(1.0, sum, change.factor, relaxing.stress);
        if (!change.prestress.empty())
            sum = sum_of(1.0, sum, 1.0, law.prestress_stress(state, change.prestress[q]));
    }
    return sum;
}

/// df at held displacements for each change: forces [changes] of the element's nodes, added to.
template <class LawAt>
void add_force_changes(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                       const Eigen::VectorXd& u, std::span<const ElementChange> changes,
                       std::span<std::array<Vec3, most_element_nodes>> forces) {
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) return;
        std::vector<PointTensors> stress(changes.size());
        for (std::size_t q = 0; q < element.geometry.size(); ++q) {
            const auto& law = response.law(q);
            const auto& state = response.state(q);
            const auto relaxing = relaxing_at(law, state);
            for (std::size_t c = 0; c < changes.size(); ++c)
                stress[c][q] = held_stress_change(law, state, relaxing, q, changes[c]);
        }
        for (std::size_t c = 0; c < changes.size(); ++c) {
            response.pull_back(stress[c]);
            for (std::size_t q = 0; q < element.geometry.size(); ++q)
                add_force(point_of(element, element.geometry[q]), stress[c][q],
                          forces[c][0].data());
        }
    });
}

/// dS of what relaxes, for each change and the displacement that follows from it.
///   du     [3 num_nodes, changes] mm
///   store  called with (change, point, dS)
template <class LawAt, class Store>
void relaxing_stress_changes(const SolidModel& model, const LawAt& law_at,
                             const ElementPoints& element, const Eigen::VectorXd& u,
                             const Eigen::MatrixXd& du, std::span<const ElementChange> changes,
                             const Store& store) {
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) return;
        std::vector<PointTensors> along(changes.size());
        for (std::size_t c = 0; c < changes.size(); ++c) {
            const double* column = du.col(static_cast<Eigen::Index>(c)).data();
            PointTensors given{};
            for (std::size_t q = 0; q < element.geometry.size(); ++q)
                given[q] = displacement_gradient(point_of(element, element.geometry[q]),
                                                 element.nodes.data(), column);
            response.law_directions(given, along[c]);
        }
        for (std::size_t q = 0; q < element.geometry.size(); ++q) {
            const auto& law = response.law(q);
            const auto& state = response.state(q);
            const auto relaxing = law.relaxing_at(state);
            for (std::size_t c = 0; c < changes.size(); ++c) {
                // H of the law follows the displacements, and in plane stress the held change.
                Tensor3<double> dh = along[c][q];
                if constexpr (follows_held_stress<std::decay_t<decltype(response)>>)
                    dh = sum_of(1.0, dh, 1.0,
                                response.held_direction(
                                    q, held_stress_change(law, state, relaxing, q, changes[c])));
                store(c, q, law.relaxing_stress_change(state, relaxing, dh, changes[c].parameters));
            }
        }
    });
}

}  // namespace palpate
