// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/pressure_assembly.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "solver/base/error.hpp"
#include "solver/equilibrium/add_block.hpp"

namespace palpate {
namespace {

Vec3 at_point(const ParametricPoint& point, const Face& face, const Eigen::VectorXd& nodal) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t a = 0; a < face.size(); ++a)
        // v(x) = sum N_a v_a
        sum += point.value[a] * nodal.segment<3>(3 * face[a]);
    return sum;
}

}  // namespace

void check_pressures(const SolidModel& model, const std::vector<double>& pressure_kpa) {
    const std::size_t count = model.pressures.size();
    if (!pressure_kpa.empty() && pressure_kpa.size() != count)
        throw Error(ErrorCode::invalid_argument,
                    "following pressures are one number for each surface: " +
                        std::to_string(count) + ", not " + std::to_string(pressure_kpa.size()));
    for (const double kpa : pressure_kpa)
        if (!std::isfinite(kpa))
            throw Error(ErrorCode::invalid_argument, "a following pressure is not a finite number");
}

PressureAssembly::PressureAssembly(const SolidModel& model)
    : model_(model), pressure_kpa_(model.pressures.size(), 0.0) {}

void PressureAssembly::set(const std::vector<double>& pressure_kpa) {
    check_pressures(model_, pressure_kpa);
    pressure_kpa_ = pressure_kpa;
    pressure_kpa_.resize(model_.pressures.size(), 0.0);
}

std::array<Vec3, 6> PressureAssembly::places(const Face& face, const Eigen::VectorXd& u) const {
    std::array<Vec3, 6> place;
    for (std::size_t a = 0; a < face.size(); ++a)
        place[a] = model_.mesh.nodes[face[a]] + u.segment<3>(3 * face[a]);
    return place;
}

/// Calls visit(face, its points, number of the surface).
template <class Visit>
void PressureAssembly::for_each_face(const Visit& visit) const {
    for (std::size_t k = 0; k < model_.pressures.size(); ++k)
        for (const Face& face : model_.pressures[k].faces)
            visit(face, parametric_points(model_.mesh.formulation, face.size()), k);
}

void PressureAssembly::add_force(const Eigen::VectorXd& u, InternalForce& sum) const {
    if (is_empty() || !sum.is_valid) return;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(u.size());
    for_each_face([&](const Face& face, const auto& points, std::size_t k) {
        if (pressure_kpa_[k] == 0) return;
        const auto place = places(face, u);
        for (const ParametricPoint& point : points) {
            const DeformedArea area(model_.mesh, point, place, face.size());
            const double size = pressure_kpa_[k] * point.weight;
            for (std::size_t a = 0; a < face.size(); ++a)
                // f_a = -P w N_a c (method.md, 9.17)
                force.segment<3>(3 * face[a]) -= size * point.value[a] * area.vector();
        }
    });
    sum.pressure_force = force.norm();
    sum.force -= force;
    sum.is_valid = force.allFinite();
    if (!sum.is_valid) sum.energy = std::numeric_limits<double>::infinity();
}

double PressureAssembly::work(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
    double sum = 0;
    if (is_empty()) return sum;
    const Eigen::VectorXd way = to - from, middle = 0.5 * (from + to);
    for_each_face([&](const Face& face, const auto& points, std::size_t k) {
        if (pressure_kpa_[k] == 0) return;
        const auto begin = places(face, from), half = places(face, middle), end = places(face, to);
        for (const ParametricPoint& point : points) {
            const auto area = [&](const auto& place) -> Vec3 {
                return DeformedArea(model_.mesh, point, place, face.size()).vector();
            };
            // int_0^1 f(u + s du) . du ds, f of degree 2 in s: Simpson's rule is exact.
            const Vec3 mean = (area(begin) + 4 * area(half) + area(end)) / 6;
            sum -= pressure_kpa_[k] * point.weight * at_point(point, face, way).dot(mean);
        }
    });
    return sum;
}

/// The parts K_ab of the load stiffness at u, face by face and point by point.
template <class Visit>
void PressureAssembly::for_each_slope(const Eigen::VectorXd& u, const Visit& visit) const {
    for_each_face([&](const Face& face, const auto& points, std::size_t k) {
        if (pressure_kpa_[k] == 0) return;
        const auto place = places(face, u);
        for (const ParametricPoint& point : points) {
            const DeformedArea area(model_.mesh, point, place, face.size());
            const double size = pressure_kpa_[k] * point.weight;
            for (std::size_t b = 0; b < face.size(); ++b) {
                const Mat3 slope = size * area.slope(b);
                for (std::size_t a = 0; a < face.size(); ++a)
                    // K_ab = P w N_a dc/du_b (method.md, 9.18)
                    visit(face[a], face[b], Mat3(point.value[a] * slope));
            }
        }
    });
}

/// Adds sign (K + of_transpose K^T) / 2.
void PressureAssembly::add_part(const Eigen::VectorXd& u, double of_transpose, double sign,
                                BlockMatrix& matrix) const {
    for_each_slope(u, [&](Index a, Index b, const Mat3& slope) {
        const Mat3 part = 0.5 * sign * slope;
        add_block(matrix, a, b, part);
        add_block(matrix, b, a, of_transpose * part.transpose());
    });
}

void PressureAssembly::add_symmetric(const Eigen::VectorXd& u, BlockMatrix& matrix) const {
    add_part(u, 1, 1, matrix);
}

void PressureAssembly::add_antisymmetric(const Eigen::VectorXd& u, bool is_transposed,
                                         BlockMatrix& matrix) const {
    // ((K - K^T) / 2)^T = -(K - K^T) / 2
    add_part(u, -1, is_transposed ? -1 : 1, matrix);
}

std::vector<MatrixEntry> PressureAssembly::antisymmetric_entries(const Eigen::VectorXd& u,
                                                                 double negligible) const {
    std::map<std::pair<Index, Index>, Mat3> blocks;  // K_ab - K_ba^T of nodes that share a face
    for_each_slope(u, [&](Index a, Index b, const Mat3& slope) {
        blocks.try_emplace({a, b}, Mat3::Zero()).first->second += slope;
        blocks.try_emplace({b, a}, Mat3::Zero()).first->second -= slope.transpose();
    });
    std::vector<MatrixEntry> entries;
    for (const auto& [nodes, block] : blocks)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (std::abs(block(i, j)) > 2 * negligible)
                    entries.push_back(
                        {3 * nodes.first + i, 3 * nodes.second + j, 0.5 * block(i, j)});
    return entries;
}

std::vector<double> PressureAssembly::products(const Eigen::VectorXd& u,
                                               const Eigen::VectorXd& lambda) const {
    std::vector<double> sum(model_.pressures.size(), 0.0);
    for_each_face([&](const Face& face, const auto& points, std::size_t k) {
        const auto place = places(face, u);
        for (const ParametricPoint& point : points) {
            const DeformedArea area(model_.mesh, point, place, face.size());
            // lambda . df/dP = -sum w lambda(x) . c
            sum[k] -= point.weight * at_point(point, face, lambda).dot(area.vector());
        }
    });
    return sum;
}

}  // namespace palpate
