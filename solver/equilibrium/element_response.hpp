// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "solver/equilibrium/pointwise.hpp"
#include "solver/equilibrium/viscous_step.hpp"
#include "solver/model/mean_volume.hpp"

// Energy, forces and stiffness of one element of any type, law and formulation.
namespace palpate {

struct ElementForce {
    double energy = 0;  ///< mN mm; infinite if a point is not valid
    std::array<Vec3, most_element_nodes> force;
};

/// [nodes, nodes, 3, 3]
using ElementStiffness = std::array<double, 9 * most_element_nodes * most_element_nodes>;

/// The laws of an element's points, made once.
template <class Law>
class PointLaws {
public:
    template <class LawAt>
    PointLaws(const LawAt& law_at, std::size_t count) {
        for (std::size_t q = 0; q < count; ++q) laws_[q].emplace(law_at(q));
    }
    const Law& operator()(std::size_t q) const { return *laws_[q]; }

private:
    std::array<std::optional<Law>, most_element_points> laws_;
};

/// Calls `work` with the response of the element that formulation and volume treatment ask for.
/// `law_at(q)`: the law of point q.
template <class LawAt, class Work>
void with_response(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                   const Eigen::VectorXd& u, Work&& work) {
    using Law = std::decay_t<decltype(law_at(std::size_t{0}))>;
    if (model.mesh.formulation == Formulation::plane_stress) {
        work(Pointwise<PlaneStressResponse<Law>>(law_at, element, u));
    } else if (model.volume == VolumeTreatment::element_mean) {
        const PointLaws<Law> laws(law_at, element.geometry.size());
        work(MeanVolume<Law, PointLaws<Law>, ElementPoints>(laws, element, u.data()));
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
            add_force(point_of(element, element.geometry[q]), stress[q], result.force[0].data());
    });
    return result;
}

/// Points that know nothing of each other: from the nine moduli of each.
template <class PointResponse>
void add_stiffness(const Pointwise<PointResponse>& response, const ElementPoints& element,
                   ElementStiffness& stiffness) {
    Tensor3<double> moduli[9];
    for (std::size_t q = 0; q < element.geometry.size(); ++q) {
        moduli_of([&](const Tensor3<double>& dh) { return response.tangent_apply_at(q, dh); },
                  moduli);
        add_stiffness(point_of(element, element.geometry[q]), moduli, stiffness.data());
    }
}

/// Elements whose points share their volume change.
template <class Response>
void add_stiffness(const Response& response, const ElementPoints&, ElementStiffness& stiffness) {
    response.add_stiffness(stiffness.data());
}

template <class LawAt>
void element_tangent(const SolidModel& model, const LawAt& law_at, const ElementPoints& element,
                     const Eigen::VectorXd& u, ElementStiffness& stiffness) {
    std::fill_n(stiffness.data(), 9 * element.nodes.size() * element.nodes.size(), 0.0);
    with_response(model, law_at, element, u, [&](const auto& response) {
        if (response.is_valid()) add_stiffness(response, element, stiffness);
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
