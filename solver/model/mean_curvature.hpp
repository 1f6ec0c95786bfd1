// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/model/solid_geometry.hpp"

namespace palpate {

/// The stiffness of an element whose points share a mean volume (`MeanDilatation`), in closed form.
/// With g = F^-T, r = g : dF, D = dF - (r / 3) F, p = s P' : F / 3 and a = dtheta / theta = b . du
/// the second variation of the energy is
///   d2W = sum V (dF : M : dF + 2 a m : dF + c a^2) - pi V theta a^2,
///   dF : M : dF = s^2 D : A : D - (2/3) s r (P' : dF) + (p / 3 + pi J) r^2
///                 + (p - pi J) tr((dF F^-1)^2),
///   m = (s^2 (A F projected as D is) + s P' - p g) / 3,    c = s^2 F : A : F / 9 + p / 3,
/// A = dP'/dF' the moduli of the law (from Simo, Taylor and Pister 1985, varied once more).
template <typename Real>
class MeanCurvature {
public:
    /// What is known of one point.
    struct Point {
        SolidPoint<Real> geometry;
        const Tensor3<Real>&f, &g, &stress;  ///< F, F^-T, P'
        Real scale = 1, volume_ratio = 1;    ///< s, J
        Real pressure = 0;                   ///< p
    };

    /// `volume` is V theta of the element, `mean_pressure` pi.
    template <class Element>
    PALPATE_DEVICE MeanCurvature(const Element& element, Real volume, Real mean_pressure)
        : nodes_(element.point(0).num_nodes),
          volume_(volume),
          mean_pressure_(mean_pressure),
          on_square_(-mean_pressure * volume) {
        bool is_plane = true;
        for (int q = 0; q < element.num_points(); ++q)
            for (int a = 0; a < nodes_; ++a)
                is_plane = is_plane && element.point(q).gradient[3 * a + 2] == 0;
        // Nothing leaves a plane: there are neither those entries of H nor those dofs.
        for (int k = 0; k < 9; ++k)
            if (!is_plane || k == 8 || (k / 3 < 2 && k % 3 < 2)) {
                position_[k] = count_;
                entries_[count_++] = k;
            }
        if (is_plane) dimension_ = 2;
    }

    /// `moduli(dF)`: A dF.
    template <class Moduli>
    PALPATE_DEVICE void add_point(const Point& at, const Moduli& moduli) {
        Tensor3<Real> column[9];
        for (int e = 0; e < count_; ++e) {
            Tensor3<Real> unit{};
            unit.m[entries_[e]] = 1;
            column[e] = moduli(unit);
        }
        Tensor3<Real> along{};  // A F
        for (int e = 0; e < count_; ++e)
            along = sum_of(Real(1), along, at.f.m[entries_[e]], column[e]);
        const Real stretch = double_dot(at.f, along);  // F : A : F
        const Real s = at.scale, square = s * s, p = at.pressure;
        const Real pi_j = mean_pressure_ * at.volume_ratio;
        Real m[9];
        for (int e = 0; e < count_; ++e) {
            const int k = entries_[e];
            const Real projected = along.m[k] - stretch / 3 * at.g.m[k];
            m[e] = (square * projected + s * at.stress.m[k] - p * at.g.m[k]) / 3;
        }
        Real matrix[9][9];
        const Real on_g = square * stretch / 9 + p / 3 + pi_j;
        for (int e = 0; e < count_; ++e) {
            const int k = entries_[e], b = k / 3, c = k % 3;
            for (int h = 0; h < count_; ++h) {
                const int l = entries_[h], d = l / 3, a = l % 3;
                const Real mixed = at.g.m[k] * (square * along.m[l] + s * at.stress.m[l]) +
                                   at.g.m[l] * (square * along.m[k] + s * at.stress.m[k]);
                // tr((dF F^-1)^2) = sum dF_bc dF_da g_ba g_dc
                matrix[e][h] = square * column[h].m[k] - mixed / 3 + on_g * at.g.m[k] * at.g.m[l] +
                               (p - pi_j) * at.g.m[3 * b + a] * at.g.m[3 * d + c];
            }
        }
        on_square_ += at.geometry.volume * (square * stretch / 9 + p / 3);
        add_products(at, matrix, m);
    }

    PALPATE_DEVICE void add_to(Real* blocks) const {
        for (int a = 0; a < nodes_; ++a)
            for (int b = 0; b < nodes_; ++b)
                for (int i = 0; i < dimension_; ++i)
                    for (int j = 0; j < dimension_; ++j) {
                        const int row = dimension_ * a + i, of = dimension_ * b + j;
                        blocks[9 * (a * nodes_ + b) + 3 * i + j] +=
                            stiffness_[row][of] + mean_[row] * linear_[of] +
                            linear_[row] * mean_[of] + on_square_ * mean_[row] * mean_[of];
                    }
    }

private:
    static constexpr int max_dofs = 3 * most_element_nodes;

    /// list : dH by component j of node b, of the entries that there are.
    PALPATE_DEVICE Real along(const SolidPoint<Real>& point, const Real* list, int b, int j) const {
        Real sum = j == 0 && point.hoop ? list[position_[8]] * point.hoop[b] : Real(0);
        for (int k = 0; k < dimension_; ++k)
            sum += list[position_[3 * j + k]] * point.gradient[3 * b + k];
        return sum;
    }

    /// V dF_row : M : dF_column of all dofs, V m : dF and b.
    PALPATE_DEVICE void add_products(const Point& at, const Real (&matrix)[9][9], const Real* m) {
        const SolidPoint<Real>& point = at.geometry;
        Real g[9], stress[9];
        for (int e = 0; e < count_; ++e) g[e] = at.g.m[entries_[e]];
        for (int b = 0; b < nodes_; ++b)
            for (int j = 0; j < dimension_; ++j) {
                const int of = dimension_ * b + j;
                for (int e = 0; e < count_; ++e)
                    stress[e] = point.volume * along(point, matrix[e], b, j);  // V M dF
                linear_[of] += point.volume * along(point, m, b, j);
                mean_[of] += point.volume * at.volume_ratio * along(point, g, b, j) / volume_;
                for (int a = 0; a < nodes_; ++a)
                    for (int i = 0; i < dimension_; ++i)
                        stiffness_[dimension_ * a + i][of] += along(point, stress, a, i);
            }
    }

    int nodes_, dimension_ = 3, count_ = 0;
    int entries_[9] = {}, position_[9] = {};  ///< of H that there are, and where each stands
    Real volume_, mean_pressure_;
    Real on_square_;  ///< of a^2
    Real stiffness_[max_dofs][max_dofs] = {};
    Real mean_[max_dofs] = {}, linear_[max_dofs] = {};  ///< b, sum V m : dF
};

}  // namespace palpate
