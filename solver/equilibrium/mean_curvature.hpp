// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "solver/equilibrium/element_points.hpp"

namespace palpate {

/// The stiffness of an element whose points share a mean volume (`MeanDilatation`), in closed form.
/// With g = F^-T, r = g : dF, D = dF - (r / 3) F, p = s P' : F / 3 and a = dtheta / theta = b . du
/// the second variation of the energy is
///   d2W = sum V (dF : M : dF + 2 a m : dF + c a^2) - pi V theta a^2,
///   dF : M : dF = s^2 D : A : D - (2/3) s r (P' : dF) + (p / 3 + pi J) r^2
///                 + (p - pi J) tr((dF F^-1)^2),
///   m = (s^2 (A F projected as D is) + s P' - p g) / 3,    c = s^2 F : A : F / 9 + p / 3,
/// A = dP'/dF' the moduli of the law (from Simo, Taylor and Pister 1985, varied once more).
class MeanCurvature {
public:
    /// What is known of one point.
    struct Point {
        const PointGeometry& geometry;
        const Tensor3<double>&f, &g, &stress;  ///< F, F^-T, P'
        double scale = 1, volume_ratio = 1;    ///< s, J
        double pressure = 0;                   ///< p
    };

    /// `volume` is V theta of the element, `mean_pressure` pi.
    MeanCurvature(const ElementPoints& element, double volume, double mean_pressure)
        : nodes_(static_cast<int>(element.nodes.size())),
          volume_(volume),
          mean_pressure_(mean_pressure),
          on_square_(-mean_pressure * volume) {
        bool is_plane = true;
        for (const PointGeometry& at : element.geometry)
            for (int a = 0; a < nodes_; ++a) is_plane = is_plane && at.gradient[a][2] == 0;
        // Nothing leaves a plane: there are neither those entries of H nor those dofs.
        if (is_plane) {
            dimension_ = 2;
            entries_ = {0, 1, 3, 4, 8};
            count_ = 5;
        } else {
            entries_ = {0, 1, 2, 3, 4, 5, 6, 7, 8};
            count_ = 9;
        }
        for (int e = 0; e < count_; ++e) place_[entries_[e]] = e;
    }

    /// `moduli(dF)`: A dF.
    template <class Moduli>
    void add_point(const Point& at, const Moduli& moduli) {
        std::array<Tensor3<double>, 9> column;
        for (int e = 0; e < count_; ++e) {
            Tensor3<double> unit{};
            unit.m[entries_[e]] = 1;
            column[e] = moduli(unit);
        }
        Tensor3<double> along{};  // A F
        for (int e = 0; e < count_; ++e) along = sum_of(1.0, along, at.f.m[entries_[e]], column[e]);
        const double stretch = double_dot(at.f, along);  // F : A : F
        const double s = at.scale, square = s * s, p = at.pressure;
        const double pi_j = mean_pressure_ * at.volume_ratio;
        std::array<double, 9> m;
        for (int e = 0; e < count_; ++e) {
            const int k = entries_[e];
            const double projected = along.m[k] - stretch / 3 * at.g.m[k];
            m[e] = (square * projected + s * at.stress.m[k] - p * at.g.m[k]) / 3;
        }
        Square matrix;
        const double on_g = square * stretch / 9 + p / 3 + pi_j;
        for (int e = 0; e < count_; ++e) {
            const int k = entries_[e], b = k / 3, c = k % 3;
            for (int h = 0; h < count_; ++h) {
                const int l = entries_[h], d = l / 3, a = l % 3;
                const double mixed = at.g.m[k] * (square * along.m[l] + s * at.stress.m[l]) +
                                     at.g.m[l] * (square * along.m[k] + s * at.stress.m[k]);
                // tr((dF F^-1)^2) = sum dF_bc dF_da g_ba g_dc
                matrix[e][h] = square * column[h].m[k] - mixed / 3 + on_g * at.g.m[k] * at.g.m[l] +
                               (p - pi_j) * at.g.m[3 * b + a] * at.g.m[3 * d + c];
            }
        }
        on_square_ += at.geometry.volume * (square * stretch / 9 + p / 3);
        add_products(at, matrix, m);
    }

    void add_to(double* blocks) const {
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
    static constexpr int most_dofs = 3 * most_element_nodes;
    using Square = std::array<std::array<double, 9>, 9>;
    using Row = std::array<double, most_dofs>;

    /// V dF_row : M : dF_column of all dofs, V m : dF and b.
    void add_products(const Point& at, const Square& matrix, const std::array<double, 9>& m) {
        const PointGeometry& geometry = at.geometry;
        const double volume = geometry.volume;
        for (int b = 0; b < nodes_; ++b)
            for (int j = 0; j < dimension_; ++j) {
                const int of = dimension_ * b + j;
                const auto along = [&](const auto& list) {
                    double sum = j == 0 ? list[place_[8]] * geometry.hoop[b] : 0;
                    for (int k = 0; k < dimension_; ++k)
                        sum += list[place_[3 * j + k]] * geometry.gradient[b][k];
                    return sum;
                };
                std::array<double, 9> stress;  // V M dF
                for (int e = 0; e < count_; ++e) stress[e] = volume * along(matrix[e]);
                linear_[of] += volume * along(m);
                double rate = j == 0 ? at.g.m[8] * geometry.hoop[b] : 0;
                for (int k = 0; k < dimension_; ++k)
                    rate += at.g.m[3 * j + k] * geometry.gradient[b][k];
                mean_[of] += volume * at.volume_ratio * rate / volume_;
                for (int a = 0; a < nodes_; ++a)
                    for (int i = 0; i < dimension_; ++i) {
                        double sum = i == 0 ? stress[place_[8]] * geometry.hoop[a] : 0;
                        for (int k = 0; k < dimension_; ++k)
                            sum += stress[place_[3 * i + k]] * geometry.gradient[a][k];
                        stiffness_[dimension_ * a + i][of] += sum;
                    }
            }
    }

    int nodes_, dimension_ = 3, count_ = 9;
    std::array<int, 9> entries_{}, place_{};  ///< of H that there are, and where each stands
    double volume_, mean_pressure_;
    double on_square_;  ///< of a^2
    std::array<Row, most_dofs> stiffness_{};
    Row mean_{}, linear_{};  ///< b, sum V m : dF
};

}  // namespace palpate
