// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "solver/equilibrium/point_response.hpp"
#include "solver/model/solid_model.hpp"

// Energy, forces and stiffness of one element of any type, law and formulation.
namespace palpate {

/// What the loops need of one element.
struct ElementPoints {
    std::span<const Index> nodes;
    std::span<const PointGeometry> geometry;  ///< [num_points]
    Formulation formulation;
};

struct ElementForce {
    double energy = 0;  ///< mN mm; infinite if a point is not valid
    std::array<Vec3, most_element_nodes> force;
};

using ElementStiffness = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                       3 * most_element_nodes, 3 * most_element_nodes>;

/// H at one point of the displacement u [3 num_nodes].
inline Tensor3<double> displacement_gradient(const ElementPoints& element, const PointGeometry& at,
                                             const Eigen::VectorXd& u) {
    Tensor3<double> h{};
    for (std::size_t a = 0; a < element.nodes.size(); ++a) {
        const double* ua = u.data() + 3 * static_cast<std::size_t>(element.nodes[a]);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) h.m[3 * i + j] += ua[i] * at.gradient[a][j];
        h.m[8] += ua[0] * at.hoop[a];
    }
    return h;
}

/// P : dH/du_a, the force of the stress P on node a, without the volume.
inline Vec3 force_on(const Tensor3<double>& stress, const PointGeometry& at, std::size_t a) {
    Vec3 force;
    for (int i = 0; i < 3; ++i)
        force[i] = stress.m[3 * i] * at.gradient[a][0] + stress.m[3 * i + 1] * at.gradient[a][1] +
                   stress.m[3 * i + 2] * at.gradient[a][2];
    force[0] += stress.m[8] * at.hoop[a];
    return force;
}

/// dH by component j of node b.
inline Tensor3<double> unit_gradient(const PointGeometry& at, std::size_t b, int j) {
    Tensor3<double> h{};
    for (int k = 0; k < 3; ++k) h.m[3 * j + k] = at.gradient[b][k];
    if (j == 0) h.m[8] += at.hoop[b];
    return h;
}

template <class PointResponse, class Law>
void add_force(const Law& law, const ElementPoints& element, const PointGeometry& at,
               const Eigen::VectorXd& u, ElementForce& result) {
    const PointResponse response(law, displacement_gradient(element, at, u));
    if (!response.is_valid()) {
        result.energy = std::numeric_limits<double>::infinity();
        return;
    }
    result.energy += at.volume * response.energy();
    const Tensor3<double> stress = response.stress();
    for (std::size_t a = 0; a < element.nodes.size(); ++a)
        result.force[a] += at.volume * force_on(stress, at, a);
}

template <class Law>
ElementForce element_force(const Law& law, const ElementPoints& element, const Eigen::VectorXd& u) {
    ElementForce result;
    result.force.fill(Vec3::Zero());
    for (const PointGeometry& at : element.geometry) {
        if (element.formulation == Formulation::plane_stress) {
            add_force<PlaneStressResponse<Law>>(law, element, at, u, result);
        } else {
            add_force<FullResponse<Law>>(law, element, at, u, result);
        }
    }
    return result;
}

template <class PointResponse, class Law>
void add_tangent(const Law& law, const ElementPoints& element, const PointGeometry& at,
                 const Eigen::VectorXd& u, ElementStiffness& stiffness) {
    const PointResponse response(law, displacement_gradient(element, at, u));
    if (!response.is_valid()) return;
    for (std::size_t b = 0; b < element.nodes.size(); ++b)
        for (int j = 0; j < 3; ++j) {
            const Tensor3<double> change = response.tangent_apply(unit_gradient(at, b, j));
            for (std::size_t a = 0; a < element.nodes.size(); ++a)
                stiffness.block<3, 1>(3 * a, 3 * b + j) += at.volume * force_on(change, at, a);
        }
}

template <class Law>
void element_tangent(const Law& law, const ElementPoints& element, const Eigen::VectorXd& u,
                     ElementStiffness& stiffness) {
    const auto size = static_cast<Eigen::Index>(3 * element.nodes.size());
    stiffness.setZero(size, size);
    for (const PointGeometry& at : element.geometry) {
        if (element.formulation == Formulation::plane_stress) {
            add_tangent<PlaneStressResponse<Law>>(law, element, at, u, stiffness);
        } else {
            add_tangent<FullResponse<Law>>(law, element, at, u, stiffness);
        }
    }
}

/// Of df/dp for parameter k of the law, weighted by `lambda`: sum over the points of
/// volume dP/dp : grad lambda.
template <class PointResponse, class Law>
double parameter_product_at(const Law& law, const ElementPoints& element, const PointGeometry& at,
                            const Eigen::VectorXd& u, const Eigen::VectorXd& lambda, int k) {
    const PointResponse response(law, displacement_gradient(element, at, u));
    if (!response.is_valid()) return 0;
    return at.volume *
           double_dot(response.parameter_stress(k), displacement_gradient(element, at, lambda));
}

template <class Law>
double parameter_product(const Law& law, const ElementPoints& element, const Eigen::VectorXd& u,
                         const Eigen::VectorXd& lambda, int k) {
    double sum = 0;
    for (const PointGeometry& at : element.geometry) {
        if (element.formulation == Formulation::plane_stress) {
            sum += parameter_product_at<PlaneStressResponse<Law>>(law, element, at, u, lambda, k);
        } else {
            sum += parameter_product_at<FullResponse<Law>>(law, element, at, u, lambda, k);
        }
    }
    return sum;
}

}  // namespace palpate
