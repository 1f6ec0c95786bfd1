// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <math.h>

#include <type_traits>

#include "solver/materials/linear_law.hpp"
#include "solver/model/mean_curvature.hpp"
#include "solver/model/solid_geometry.hpp"

// Elements whose points change their volume alike: with one pressure per element tet10 and quad4 do
// not lock near incompressibility (Simo, Taylor and Pister 1985; Simo and Taylor 1991). For host
// loops and device kernels; the twin of kernels/solid_response.cl. `LawAt` gives the law of point
// q, `Element` has num_points(), point(q) and displacement_gradient_at(q, u).
//
// The law of a point sees H'(H, theta), theta common to the element. With V the element's volume
//   c = V dtheta/du = sum over points of volume (dJ/dH : dH/du),
//   pi = (1/V) dW/dtheta,   f = f|theta + pi c,   b = df|theta/dtheta = V dpi/du|theta,
// so that with K|theta the stiffness while theta and pi are held
//   K = K|theta + (b c^T + c b^T) / V + dpi/dtheta c c^T / V.
namespace palpate {

/// What both kinds below have in common. `Kind` has
///   held_change(q, dh, theta_change, pressure_change)  dP of point q while pi is held, for its dH
///       and dtheta; writes the change of the point's pressure dW_q/dtheta, W_q per volume
/// and fills the members on construction.
template <class Kind, class Law, class LawAt, class Element>
class MeanVolumeBase {
public:
    using Real = typename Law::Number;
    using Tensors = TensorsAtPoints<Real>;

    PALPATE_DEVICE bool is_valid() const { return is_valid_; }
    PALPATE_DEVICE Real energy() const {
        Real sum = 0;
        for (int q = 0; q < count_; ++q) sum += volume_at(q) * law(q).energy(states_[q]);
        return sum;
    }
    /// P = P|theta + pi dJ/dH at every point.
    PALPATE_DEVICE void stress(Tensors& p) const {
        for (int q = 0; q < count_; ++q)
            p[q] = sum_of(Real(1), held_stress_[q], mean_pressure_, volume_slope_[q]);
    }
    /// dP for changes dH of the points' displacement gradients.
    PALPATE_DEVICE void tangent_apply(const Tensors& dh, Tensors& dp) const {
        // dtheta = (1/V) sum volume dJ,  dpi = (1/V) sum volume d(dW_q/dtheta)
        const Real theta_change = theta_change_of(dh);
        Real pressure_change[most_element_points];
        for (int q = 0; q < count_; ++q)
            dp[q] = kind().held_change(q, dh[q], theta_change, pressure_change[q]);
        const Real mean_change = mean_of(pressure_change);
        for (int q = 0; q < count_; ++q)
            dp[q] = sum_of(Real(1), dp[q], mean_change, volume_slope_[q]);
    }
    /// Adds K [num_nodes, num_nodes, 3, 3] to blocks.
    PALPATE_DEVICE void add_stiffness(Real* blocks) const {
        Real c[3 * most_element_nodes] = {}, b[3 * most_element_nodes] = {};
        Real pressure_by_theta[most_element_points];
        for (int q = 0; q < count_; ++q) {
            const SolidPoint<Real> point = element_.point(q);
            Real unused;
            Tensor3<Real> moduli[9];
            moduli_of([&](const auto& dh) { return kind().held_change(q, dh, 0, unused); }, moduli);
            palpate::add_stiffness(point, moduli, blocks);
            add_force(point, volume_slope_[q], c);
            add_force(point, kind().held_change(q, Tensor3<Real>{}, 1, pressure_by_theta[q]), b);
        }
        const Real curvature = mean_of(pressure_by_theta);
        const int n = element_.point(0).num_nodes;
        for (int row = 0; row < 3 * n; ++row)
            for (int column = 0; column < 3 * n; ++column)
                // (b c^T + c b^T) / V + dpi/dtheta c c^T / V
                blocks[9 * (row / 3 * n + column / 3) + 3 * (row % 3) + column % 3] +=
                    (b[row] * c[column] + c[row] * b[column] + curvature * c[row] * c[column]) /
                    volume_;
    }
    /// In these elements no gradient follows a held stress.
    PALPATE_DEVICE Tensor3<Real> held_direction(std::size_t, const Tensor3<Real>&) const {
        return {};
    }

    PALPATE_DEVICE decltype(auto) law(std::size_t q) const { return law_at_(q); }
    PALPATE_DEVICE const typename Law::State& state(std::size_t q) const { return states_[q]; }
    /// H' as the law has it.
    PALPATE_DEVICE const Tensor3<Real>& gradient(std::size_t q) const { return law_gradient_[q]; }

protected:
    PALPATE_DEVICE MeanVolumeBase(const LawAt& law_at, const Element& element)
        : law_at_(law_at), element_(element), count_(element.num_points()) {
        for (int q = 0; q < count_; ++q) volume_ += volume_at(q);
    }
    PALPATE_DEVICE Real volume_at(int q) const { return element_.point(q).volume; }
    PALPATE_DEVICE Real theta_change_of(const Tensors& dh) const {
        Real change[most_element_points];
        for (int q = 0; q < count_; ++q) change[q] = double_dot(volume_slope_[q], dh[q]);
        return mean_of(change);
    }
    PALPATE_DEVICE Real mean_of(const Real* values) const {
        Real sum = 0;
        for (int q = 0; q < count_; ++q) sum += volume_at(q) * values[q];
        return sum / volume_;
    }

    const LawAt& law_at_;
    const Element& element_;
    int count_;
    Real volume_ = 0;         ///< V
    Real mean_pressure_ = 0;  ///< pi
    bool is_valid_ = false;
    typename Law::State states_[most_element_points];
    Tensors law_gradient_ = {};  ///< H'
    Tensors held_stress_;        ///< P at held theta
    Tensors volume_slope_ = {};  ///< dJ/dH, at small strains I

private:
    PALPATE_DEVICE const Kind& kind() const { return static_cast<const Kind&>(*this); }
};

/// Large deformation: theta = (1/V) sum over points of volume J, F' = s F, s = (theta / J)^(1/3).
/// With g = F^-T and p = P(F') : F' / 3 = theta dW_q/dtheta: P|theta = s P(F') - p g.
template <class Law, class LawAt, class Element>
class MeanDilatation
    : public MeanVolumeBase<MeanDilatation<Law, LawAt, Element>, Law, LawAt, Element> {
    using Base = MeanVolumeBase<MeanDilatation, Law, LawAt, Element>;

public:
    using typename Base::Real;
    using typename Base::Tensors;

    PALPATE_DEVICE MeanDilatation(const LawAt& law_at, const Element& element, const Real* u)
        : Base(law_at, element) {
        Real change = 0;  // of the volume
        for (int q = 0; q < this->count_; ++q) {
            Point& point = points_[q];
            point.f = element.displacement_gradient_at(q, u);
            point.volume_change = determinant_change(point.f);
            change += this->volume_at(q) * point.volume_change;
            if (!(1 + point.volume_change > 0)) return;
        }
        theta_ = 1 + change / this->volume_;
        Real pressure[most_element_points];
        this->is_valid_ = true;
        for (int q = 0; q < this->count_; ++q) {
            evaluate(q, log1p(change / this->volume_));
            this->is_valid_ = this->is_valid_ && this->states_[q].is_valid;
            pressure[q] = points_[q].pressure / theta_;
        }
        this->mean_pressure_ = this->mean_of(pressure);
    }

    PALPATE_DEVICE Tensor3<Real> held_change(int q, const Tensor3<Real>& dh, Real theta_change,
                                             Real& pressure_change) const {
        const Point& point = points_[q];
        const Real rate = double_dot(point.g, dh);  // dJ / J
        const Real scale_change = scale_change_of(q, theta_change, rate);
        const Tensor3<Real> df = sum_of(point.scale, dh, scale_change, point.f);  // dF'
        const Tensor3<Real> change = this->law(q).tangent_apply(this->states_[q], df);
        // dp = (dP' : F' + P' : dF') / 3,  dg = -g dH^T g,  d(p / theta)
        const Real p_change =
            (point.scale * double_dot(change, point.f) + double_dot(point.stress, df)) / 3;
        const Tensor3<Real> g_change = times(point.g, transposed_times(dh, point.g));
        pressure_change = (p_change - point.pressure * theta_change / theta_) / theta_;
        // d(s P' - p g) + pi d(J g)
        const Real mean = this->mean_pressure_ * (1 + point.volume_change);
        return sum_of(Real(1), sum_of(scale_change, point.stress, point.scale, change), Real(1),
                      sum_of(mean * rate - p_change, point.g, point.pressure - mean, g_change));
    }
    /// In place of the general one: fewer sums, see `MeanCurvature`.
    PALPATE_DEVICE void add_stiffness(Real* blocks) const {
        MeanCurvature<Real> curvature(this->element_, this->volume_ * theta_, this->mean_pressure_);
        for (int q = 0; q < this->count_; ++q) {
            const Point& point = points_[q];
            curvature.add_point({this->element_.point(q), point.f, point.g, point.stress,
                                 point.scale, 1 + point.volume_change, point.pressure},
                                this->law(q), this->states_[q]);
        }
        curvature.add_to(blocks);
    }
    /// dH' of changes dH.
    PALPATE_DEVICE void law_directions(const Tensors& dh, Tensors& given) const {
        const Real theta_change = this->theta_change_of(dh);
        for (int q = 0; q < this->count_; ++q) {
            const Point& point = points_[q];
            const Real rate = double_dot(point.g, dh[q]);
            given[q] = sum_of(point.scale, dh[q], scale_change_of(q, theta_change, rate), point.f);
        }
    }
    /// The stress on H that does the work of p on H'.
    PALPATE_DEVICE void pull_back(Tensors& p) const {
        Real pressure[most_element_points];
        for (int q = 0; q < this->count_; ++q)
            pressure[q] = points_[q].scale * double_dot(p[q], points_[q].f) / 3;
        const Real mean = this->mean_of(pressure) / theta_;
        for (int q = 0; q < this->count_; ++q)
            p[q] = sum_of(Real(1), sum_of(points_[q].scale, p[q], -pressure[q], points_[q].g), mean,
                          this->volume_slope_[q]);
    }

private:
    struct Point {
        Tensor3<Real> f;         ///< F (H until it is evaluated)
        Real volume_change = 0;  ///< J - 1
        Tensor3<Real> g;         ///< F^-T
        Real scale = 1;          ///< s
        Tensor3<Real> stress;    ///< P(F')
        Real pressure = 0;       ///< p
    };

    /// H' = s H + (s - 1) I keeps its digits near rest.
    PALPATE_DEVICE void evaluate(int q, Real log_theta) {
        Point& point = points_[q];
        const Real log_scale = (log_theta - log1p(point.volume_change)) / 3;
        point.scale = exp(log_scale);
        Tensor3<Real> h = scaled(point.f, point.scale);
        add_diagonal(h, Real(expm1(log_scale)));
        this->law_gradient_[q] = h;
        this->states_[q] = this->law(q).state(h);
        point.stress = this->law(q).stress(this->states_[q]);
        add_diagonal(point.f, Real(1));
        this->volume_slope_[q] = cofactors(point.f);
        point.g = scaled(this->volume_slope_[q], 1 / (1 + point.volume_change));
        point.pressure = point.scale * double_dot(point.stress, point.f) / 3;
        this->held_stress_[q] = sum_of(point.scale, point.stress, -point.pressure, point.g);
    }
    /// ds = s/3 (dtheta / theta - dJ / J)
    PALPATE_DEVICE Real scale_change_of(int q, Real theta_change, Real rate) const {
        return points_[q].scale / 3 * (theta_change / theta_ - rate);
    }

    Real theta_ = 1;
    Point points_[most_element_points];
};

/// Small strains (B-bar, Hughes 1980): theta - 1 is the mean of tr H, H' = H + (theta - 1 - tr H)
/// I / 3, so that the law stays linear in the displacement. P|theta = P' - tr P' I / 3.
template <class Law, class LawAt, class Element>
class MeanTrace : public MeanVolumeBase<MeanTrace<Law, LawAt, Element>, Law, LawAt, Element> {
    using Base = MeanVolumeBase<MeanTrace, Law, LawAt, Element>;

public:
    using typename Base::Real;
    using typename Base::Tensors;

    PALPATE_DEVICE MeanTrace(const LawAt& law_at, const Element& element, const Real* u)
        : Base(law_at, element) {
        for (int q = 0; q < this->count_; ++q) {
            this->law_gradient_[q] = element.displacement_gradient_at(q, u);
            add_diagonal(this->volume_slope_[q], Real(1));
        }
        law_directions(this->law_gradient_, this->law_gradient_);
        Real pressure[most_element_points];
        this->is_valid_ = true;
        for (int q = 0; q < this->count_; ++q) {
            this->states_[q] = this->law(q).state(this->law_gradient_[q]);
            this->is_valid_ = this->is_valid_ && this->states_[q].is_valid;
            this->held_stress_[q] = this->law(q).stress(this->states_[q]);
            pressure[q] = take_off_trace(this->held_stress_[q]);
        }
        this->mean_pressure_ = this->mean_of(pressure);
    }

    PALPATE_DEVICE Tensor3<Real> held_change(int q, const Tensor3<Real>& dh, Real theta_change,
                                             Real& pressure_change) const {
        Tensor3<Real> given = dh;
        add_diagonal(given, (theta_change - trace(dh)) / 3);
        Tensor3<Real> change = this->law(q).tangent_apply(this->states_[q], given);
        pressure_change = take_off_trace(change);
        return change;
    }
    PALPATE_DEVICE void law_directions(const Tensors& dh, Tensors& given) const {
        const Real theta_change = this->theta_change_of(dh);
        for (int q = 0; q < this->count_; ++q) {
            given[q] = dh[q];
            add_diagonal(given[q], (theta_change - trace(dh[q])) / 3);
        }
    }
    PALPATE_DEVICE void pull_back(Tensors& p) const {
        Real pressure[most_element_points];
        for (int q = 0; q < this->count_; ++q) pressure[q] = take_off_trace(p[q]);
        const Real mean = this->mean_of(pressure);
        for (int q = 0; q < this->count_; ++q) add_diagonal(p[q], mean);
    }

private:
    /// Leaves the deviator; returns tr / 3.
    PALPATE_DEVICE static Real take_off_trace(Tensor3<Real>& tensor) {
        const Real mean = trace(tensor) / 3;
        add_diagonal(tensor, -mean);
        return mean;
    }
};

/// The law of all points of an element.
template <class Law>
struct SameLaw {
    const Law& law;
    PALPATE_DEVICE const Law& operator()(std::size_t) const { return law; }
};

/// The kind that a law asks for.
template <class Law, class LawAt, class Element>
using MeanVolume = std::conditional_t<is_small_strain<Law>, MeanTrace<Law, LawAt, Element>,
                                      MeanDilatation<Law, LawAt, Element>>;

}  // namespace palpate
