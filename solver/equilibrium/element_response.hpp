// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <span>
#include <type_traits>

#include "solver/equilibrium/mean_dilatation.hpp"
#include "solver/equilibrium/mean_trace.hpp"
#include "solver/equilibrium/pointwise.hpp"
#include "solver/equilibrium/viscous_step.hpp"

// Energy, forces and stiffness of one element of any type, law and formulation.
namespace palpate {

struct ElementForce {
    double energy = 0;  ///< mN mm; infinite if a point is not valid
    std::array<Vec3, most_element_nodes> force;
};

using ElementStiffness = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                       3 * most_element_nodes, 3 * most_element_nodes>;

/// Calls `work` with the response of the element that formulation and volume treatment ask for.
/// `law_at(q)`: the law of point q.
template <class LawAt, class Work>
void with_response(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                   const Eigen::VectorXd& u, Work&& work) {
    using Law = std::decay_t<decltype(law_at(std::size_t{0}))>;
    if (model.mesh.formulation == Formulation::plane_stress) {
        work(Pointwise<PlaneStressResponse<Law>>(law_at, element, u));
    } else if (model.volume == VolumeTreatment::element_mean) {
        if constexpr (is_small_strain<Law>) {
            work(MeanTrace<Law>(law_at, element, u));
        } else {
            work(MeanDilatation<Law>(law_at, element, u));
        }
    } else {
        work(Pointwise<FullResponse<Law>>(law_at, element, u));
    }
}

template <class LawAt>
ElementForce element_force(const SolidModel& model, const LawAt& law_at,
                           const ElementPoints& element, const Eigen::VectorXd& u) {
    ElementForce result;
    result.force.fill(Vec3::Zero());
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) {
            result.energy = std::numeric_limits<double>::infinity();
            return;
        }
        result.energy = response.energy();
        PointTensors stress;
        response.stress(stress);
        for (std::size_t q = 0; q < element.geometry.size(); ++q)
            for (std::size_t a = 0; a < element.nodes.size(); ++a)
                result.force[a] +=
                    element.geometry[q].volume * force_on(stress[q], element.geometry[q], a);
    });
    return result;
}

template <class LawAt>
void element_tangent(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                     const Eigen::VectorXd& u, ElementStiffness& stiffness) {
    const auto size = static_cast<Eigen::Index>(3 * element.nodes.size());
    stiffness.setZero(size, size);
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) return;
        PointTensors direction, change;
        for (std::size_t b = 0; b < element.nodes.size(); ++b)
            for (int j = 0; j < 3; ++j) {
                for (std::size_t q = 0; q < element.geometry.size(); ++q)
                    direction[q] = unit_gradient(element.geometry[q], b, j);
                response.tangent_apply(direction, change);
                for (std::size_t q = 0; q < element.geometry.size(); ++q)
                    for (std::size_t a = 0; a < element.nodes.size(); ++a)
                        stiffness.block<3, 1>(3 * a, 3 * b + j) +=
                            element.geometry[q].volume *
                            force_on(change[q], element.geometry[q], a);
            }
    });
}

/// lambda . df/dp for the parameters p of the law, added to sums [parameters]: the integral of
/// dP/dp : grad lambda.
template <class LawAt>
void add_parameter_products(const SolidModel& model, const LawAt& law_at,
                            const ElementPoints& element, const Eigen::VectorXd& u,
                            const Eigen::VectorXd& lambda, std::span<double> sums) {
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) return;
        PointTensors direction{};
        for (std::size_t q = 0; q < element.geometry.size(); ++q)
            direction[q] = displacement_gradient(element, element.geometry[q], lambda);
        response.law_directions(direction, direction);
        for (std::size_t q = 0; q < element.geometry.size(); ++q)
            for (std::size_t k = 0; k < sums.size(); ++k)
                sums[k] += element.geometry[q].volume *
                           double_dot(direction[q], response.law(q).parameter_stress(
                                                        response.state(q), static_cast<int>(k)));
    });
}

/// df/dp for parameter k of the law: force[a] of every node of the element, mN per unit.
template <class LawAt>
void parameter_force(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                     const Eigen::VectorXd& u, int k, std::span<Vec3> force) {
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (!response.is_valid()) return;
        PointTensors change;
        for (std::size_t q = 0; q < element.geometry.size(); ++q)
            change[q] = response.law(q).parameter_stress(response.state(q), k);
        response.pull_back(change);
        for (std::size_t q = 0; q < element.geometry.size(); ++q)
            for (std::size_t a = 0; a < element.nodes.size(); ++a)
                force[a] +=
                    element.geometry[q].volume * force_on(change[q], element.geometry[q], a);
    });
}

/// H of every point as its law has it.
template <class LawAt>
void law_gradients(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                   const Eigen::VectorXd& u, PointTensors& h) {
    with_response(model, law_at, element, u, [&](const auto& response) {
        for (std::size_t q = 0; q < element.geometry.size(); ++q) h[q] = response.gradient(q);
    });
}

}  // namespace palpate
