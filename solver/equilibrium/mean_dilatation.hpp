// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "solver/equilibrium/element_points.hpp"
#include "solver/equilibrium/mean_curvature.hpp"

namespace palpate {

/// The response of an element in which every point changes its volume alike, by the mean
///   theta = (1/V) sum over points of volume J,   F' = s F,  s = (theta / J)^(1/3),
/// the energy being that of F'. With one pressure per element tet10 and quad4 do not lock near
/// incompressibility (Simo, Taylor and Pister 1985; Simo and Taylor 1991). With g = F^-T and
/// p = P(F') : F' / 3 at each point, pi = (sum volume p) / (V theta), the stress on F is
///   P = s P(F') - p g + pi J g.
template <class Law>
class MeanDilatation {
public:
    /// `law_at(q)`: the law of point q.
    template <class LawAt>
    MeanDilatation(const LawAt& law_at, const ElementPoints& element, const Eigen::VectorXd& u)
        : element_(element), count_(element.geometry.size()) {
        double sum = 0;
        for (std::size_t q = 0; q < count_; ++q) {
            Point& point = points_[q];
            point.law.emplace(law_at(q));
            point.f = displacement_gradient(element, element.geometry[q], u);
            point.volume_change = determinant_change(point.f);
            volume_ += element.geometry[q].volume;
            sum += element.geometry[q].volume * point.volume_change;
            if (!(1 + point.volume_change > 0)) return;
        }
        theta_ = 1 + sum / volume_;
        for (std::size_t q = 0; q < count_; ++q) evaluate(points_[q], std::log1p(sum / volume_));
        double pressure = 0;
        is_valid_ = true;
        for (std::size_t q = 0; q < count_; ++q) {
            is_valid_ = is_valid_ && points_[q].state->is_valid;
            pressure += element.geometry[q].volume * points_[q].pressure;
        }
        mean_pressure_ = pressure / (volume_ * theta_);
    }

    bool is_valid() const { return is_valid_; }
    double energy() const {
        double sum = 0;
        for (std::size_t q = 0; q < count_; ++q)
            sum += element_.geometry[q].volume * points_[q].law->energy(*points_[q].state);
        return sum;
    }
    void stress(PointTensors& p) const {
        for (std::size_t q = 0; q < count_; ++q) {
            const Point& point = points_[q];
            const double on_g = mean_pressure_ * (1 + point.volume_change) - point.pressure;
            p[q] = sum_of(point.scale, point.stress, on_g, point.g);
        }
    }
    void tangent_apply(const PointTensors& dh, PointTensors& dp) const {
        std::array<double, most_element_points> rate, scale_change, pressure_change;
        const double theta_change = find_scale_change(dh, rate, scale_change);
        PointTensors stress_change;
        for (std::size_t q = 0; q < count_; ++q) {
            const Point& point = points_[q];
            const auto df = sum_of(point.scale, dh[q], scale_change[q], point.f);
            stress_change[q] = point.law->tangent_apply(*point.state, df);
            pressure_change[q] = (point.scale * double_dot(stress_change[q], point.f) +
                                  double_dot(point.stress, df)) /
                                 3;
        }
        const double mean_change =
            mean_of(pressure_change) - mean_pressure_ * theta_change / theta_;
        for (std::size_t q = 0; q < count_; ++q) {
            const Point& point = points_[q];
            const double j = 1 + point.volume_change;
            const Tensor3<double> g_change =
                scaled(times(point.g, transposed_times(dh[q], point.g)), -1.0);
            dp[q] = sum_of(scale_change[q], point.stress, point.scale, stress_change[q]);
            const double on_g = mean_change * j + mean_pressure_ * j * rate[q] - pressure_change[q];
            const double on_change = mean_pressure_ * j - point.pressure;
            dp[q] = sum_of(1.0, dp[q], 1.0, sum_of(on_g, point.g, on_change, g_change));
        }
    }
    /// Adds the same by every pair of the element's dofs to blocks [nodes, nodes, 3, 3].
    void add_stiffness(double* blocks) const {
        MeanCurvature curvature(element_, volume_ * theta_, mean_pressure_);
        for (std::size_t q = 0; q < count_; ++q) {
            const Point& point = points_[q];
            curvature.add_point({element_.geometry[q], point.f, point.g, point.stress, point.scale,
                                 1 + point.volume_change, point.pressure},
                                [&](const Tensor3<double>& df) {
                                    return point.law->tangent_apply(*point.state, df);
                                });
        }
        curvature.add_to(blocks);
    }
    void law_directions(const PointTensors& dh, PointTensors& given) const {
        std::array<double, most_element_points> rate, scale_change;
        find_scale_change(dh, rate, scale_change);
        for (std::size_t q = 0; q < count_; ++q)
            given[q] = sum_of(points_[q].scale, dh[q], scale_change[q], points_[q].f);
    }
    void pull_back(PointTensors& p) const {
        std::array<double, most_element_points> pressure;
        for (std::size_t q = 0; q < count_; ++q)
            pressure[q] = points_[q].scale * double_dot(p[q], points_[q].f) / 3;
        const double mean = mean_of(pressure);
        for (std::size_t q = 0; q < count_; ++q) {
            const Point& point = points_[q];
            const double on_g = mean * (1 + point.volume_change) - pressure[q];
            p[q] = sum_of(point.scale, p[q], on_g, point.g);
        }
    }
    Tensor3<double> held_direction(std::size_t, const Tensor3<double>&) const { return {}; }

    const Law& law(std::size_t q) const { return *points_[q].law; }
    const auto& state(std::size_t q) const { return *points_[q].state; }
    const Tensor3<double>& gradient(std::size_t q) const { return points_[q].h; }

private:
    struct Point {
        std::optional<Law> law;
        Tensor3<double> f;                         ///< F (H until it is evaluated)
        double volume_change = 0;                  ///< J - 1
        Tensor3<double> g;                         ///< F^-T
        double scale = 1;                          ///< s
        Tensor3<double> h;                         ///< F' - I
        std::optional<typename Law::State> state;  ///< of F'
        Tensor3<double> stress;                    ///< P(F')
        double pressure = 0;                       ///< P(F') : F' / 3
    };

    /// H' = s H + (s - 1) I keeps its digits near rest.
    void evaluate(Point& point, double log_theta) {
        const double log_scale = (log_theta - std::log1p(point.volume_change)) / 3;
        point.scale = std::exp(log_scale);
        Tensor3<double> h = scaled(point.f, point.scale);
        add_diagonal(h, std::expm1(log_scale));
        point.state = point.law->state(h);
        point.stress = point.law->stress(*point.state);
        point.h = h;
        add_diagonal(point.f, 1.0);
        point.g = scaled(cofactors(point.f), 1 / (1 + point.volume_change));
        point.pressure = point.scale * double_dot(point.stress, point.f) / 3;
    }

    /// ds, and g : dF, the relative change of J; returns d theta.
    double find_scale_change(const PointTensors& dh, std::array<double, most_element_points>& rate,
                             std::array<double, most_element_points>& scale_change) const {
        double theta_change = 0;
        for (std::size_t q = 0; q < count_; ++q) {
            rate[q] = double_dot(points_[q].g, dh[q]);
            theta_change += element_.geometry[q].volume * (1 + points_[q].volume_change) * rate[q];
        }
        theta_change /= volume_;
        for (std::size_t q = 0; q < count_; ++q)
            scale_change[q] = points_[q].scale / 3 * (theta_change / theta_ - rate[q]);
        return theta_change;
    }

    double mean_of(const std::array<double, most_element_points>& pressure) const {
        double sum = 0;
        for (std::size_t q = 0; q < count_; ++q) sum += element_.geometry[q].volume * pressure[q];
        return sum / (volume_ * theta_);
    }

    const ElementPoints& element_;
    std::size_t count_;
    std::array<Point, most_element_points> points_;
    double volume_ = 0, theta_ = 1;
    double mean_pressure_ = 0;  ///< pi
    bool is_valid_ = false;
};

}  // namespace palpate
