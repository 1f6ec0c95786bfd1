// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// What is behind the tissue: a smooth dark field, a quadratic of column and row that is fitted to
/// the pixels above the outline and follows them slowly, with its noise.
class BackgroundField {
public:
    BackgroundField(Index width, Index rows);

    /// Forgets all and fits the pixels above `top` [width] rows, sampled.
    ///   columns   [width][stride] grey values, those of a column side by side
    void begin(const std::vector<float>& columns, Index stride, const std::vector<float>& top);
    /// The same, but what was known before counts, too, less with each frame.
    void update(const std::vector<float>& columns, Index stride, const std::vector<float>& top);

    /// The field in a column is p[0] + p[1] row + p[2] row^2.
    Eigen::Vector3f column(Index x) const;
    /// Standard deviation of a pixel's noise, from the median of absolute residuals.
    float sigma() const { return sigma_; }

private:
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    /// Pixels of one column: sums of v^0 to v^4, and of grey values times v^0 to v^2.
    void add_column(double u, const double* powers, const double* values);
    void gather(const std::vector<float>& columns, Index stride, const std::vector<float>& top,
                float limit);
    void solve();

    Index width_, rows_;
    Vector6 coefficients_ = Vector6::Zero(), right_ = Vector6::Zero();
    Matrix6 normal_ = Matrix6::Zero();
    float sigma_ = 0;
    std::vector<float> residuals_;
};

}  // namespace palpate
