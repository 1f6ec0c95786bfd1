// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// The outline as a whole: a Legendre series over the columns where it is seen, which dents of
/// stains and bumps of bubbles do not draw to themselves (Tukey's biweight, begun from the frame
/// before).
class OutlineShape {
public:
    static constexpr int num_terms = 9;

    explicit OutlineShape(Index width);

    /// Fits `rows` with `weights` (0: leave out), [width] both, over the columns from `first` to
    /// `last`.
    void fit(const std::vector<float>& rows, const std::vector<float>& weights, Index first,
             Index last);
    bool is_fitted() const { return is_fitted_; }
    double row(Index x) const;
    double slope(Index x) const { return 0.5 * (row(x + 1) - row(x - 1)); }
    /// 1.48 times the median of absolute residuals, pixels.
    double spread() const { return spread_; }

private:
    using Terms = Eigen::Matrix<double, num_terms, 1>;
    static constexpr int num_products = num_terms * (num_terms + 1) / 2;
    using Products = std::array<double, num_products>;  ///< of two terms each, lower triangle
    static void add_up(const Products* products, const double* weights, Index count,
                       Products& sums);
    Terms terms(Index x) const;
    void solve(const std::vector<float>& rows, const std::vector<float>& weights, double scale,
               bool is_redescending);
    double spread_of(const std::vector<float>& rows, const std::vector<float>& weights);

    Index first_ = 0, last_ = 0;  ///< columns; equal before the first fit
    bool is_fitted_ = false;
    double spread_ = 1;
    Terms coefficients_ = Terms::Zero();
    std::vector<Terms, Eigen::aligned_allocator<Terms>> table_;
    std::vector<Products> products_;
    std::vector<double> weights_, rows_;
    std::vector<float> sizes_;
};

}  // namespace palpate
