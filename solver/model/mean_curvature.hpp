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
        for (int row = 0; row < dimension_ * nodes_; ++row) {
            mean_[row] = linear_[row] = 0;
            for (int of = row; of < dimension_ * nodes_; ++of) stiffness_[row][of] = 0;
        }
    }

    /// A of the law in this state.
    template <class Law>
    PALPATE_DEVICE void add_point(const Point& at, const Law& law,
                                  const typename Law::State& state) {
        Tensor3<Real> column[9];
        moduli_of(law, state, entries_, count_, column);
        Real along[9];     // A F
        Real stretch = 0;  // F : A : F
        for (int e = 0; e < count_; ++e) {
            along[e] = 0;
            for (int h = 0; h < count_; ++h)
                along[e] += at.f.m[entries_[h]] * column[h].m[entries_[e]];
            stretch += at.f.m[entries_[e]] * along[e];
        }
        const Real s = at.scale, square = s * s, p = at.pressure;
        const Real pi_j = mean_pressure_ * at.volume_ratio;
        // m, and what g stands with beside another g
        Real m[9], mixed[9];
        for (int e = 0; e < count_; ++e) {
            const Real g = at.g.m[entries_[e]];
            const Real stress = s * at.stress.m[entries_[e]];
            m[e] = (square * (along[e] - stretch / 3 * g) + stress - p * g) / 3;
            mixed[e] = (square * along[e] + stress) / 3;
        }
        Real matrix[9][9];  // M
        const Real on_g = square * stretch / 9 + p / 3 + pi_j, on_square_of_g = p - pi_j;
        for (int e = 0; e < count_; ++e) {
            const int k = entries_[e], b = k / 3, c = k % 3;
            for (int h = 0; h <= e; ++h) {
                const int l = entries_[h], d = l / 3, a = l % 3;
                const Real g = at.g.m[k], other = at.g.m[l];
                // tr((dF F^-1)^2) = sum dF_bc dF_da g_ba g_dc
                matrix[e][h] = matrix[h][e] =
                    square * column[h].m[k] - (g * mixed[h] + other * mixed[e]) + on_g * g * other +
                    on_square_of_g * at.g.m[3 * b + a] * at.g.m[3 * d + c];
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
                            stiffness_[row < of ? row : of][row < of ? of : row] +
                            mean_[row] * linear_[of] + linear_[row] * mean_[of] +
                            on_square_ * mean_[row] * mean_[of];
                    }
    }

private:
    static constexpr int max_dofs = 3 * most_element_nodes;

    /// dH by a dof in the entries that there are: up to three of them and the hoop.
    struct Direction {
        int count = 0;
        int place[4];
        Real by[4];

        PALPATE_DEVICE void add(int at, const Real& number) {
            place[count] = at;
            by[count++] = number;
        }
        /// list : dH
        PALPATE_DEVICE Real along(const Real* list) const {
            Real sum = by[0] * list[place[0]];
            for (int k = 1; k < count; ++k) sum += by[k] * list[place[k]];
            return sum;
        }
    };
    PALPATE_DEVICE Direction direction(const SolidPoint<Real>& point, int b, int j) const {
        Direction made;
        for (int k = 0; k < dimension_; ++k)
            made.add(position_[3 * j + k], point.gradient[3 * b + k]);
        if (j == 0 && point.hoop) made.add(position_[8], point.hoop[b]);
        return made;
    }

    /// V dF_row : M : dF_column of all dofs (M is symmetric), V m : dF and b.
    PALPATE_DEVICE void add_products(const Point& at, const Real (&matrix)[9][9], const Real* m) {
        const SolidPoint<Real>& point = at.geometry;
        Real g[9], stress[9];
        for (int e = 0; e < count_; ++e) g[e] = at.g.m[entries_[e]];
        Direction directions[max_dofs];
        const Real on_mean = point.volume * at.volume_ratio / volume_;
        for (int of = 0; of < dimension_ * nodes_; ++of) {
            const Direction& own = directions[of] =
                direction(point, of / dimension_, of % dimension_);
            for (int e = 0; e < count_; ++e)
                stress[e] = point.volume * own.along(matrix[e]);  // V M dF
            linear_[of] += point.volume * own.along(m);
            mean_[of] += on_mean * own.along(g);
            for (int row = 0; row <= of; ++row)
                stiffness_[row][of] += directions[row].along(stress);
        }
    }

    int nodes_, dimension_ = 3, count_ = 0;
    int entries_[9] = {}, position_[9] = {};  ///< of H that there are, and where each stands
    Real volume_, mean_pressure_;
    Real on_square_;                          ///< of a^2
    Real stiffness_[max_dofs][max_dofs];      ///< of column >= row
    Real mean_[max_dofs], linear_[max_dofs];  ///< b, sum V m : dF
};

}  // namespace palpate
