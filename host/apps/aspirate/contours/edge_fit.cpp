// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/edge_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "solver/base/multiversion.hpp"

namespace palpate {
namespace {

constexpr Index half_rows = 4, num_rows = 2 * half_rows + 1;
constexpr int iterations = 3;
constexpr float dark_sd = 4, slope_part = 0.03F;
constexpr float farthest = 3, no_sd = 3;  // pixels

/// A number of each of eight columns: they are fitted side by side in the lanes of the processor.
constexpr Index lanes = 8;
using Lane = Eigen::Array<float, lanes, 1>;

/// Normal equations of a, step, row, d: the lower triangle by rows.
struct NormalEquations {
    Lane m00, m10, m11, m20, m21, m22, m30, m31, m32, m33, r0, r1, r2, r3;
};

/// L D L^T of the normal equations.
struct Factor {
    Lane l10, l20, l21, l30, l31, l32, d0, d1, d2, d3;

    explicit Factor(const NormalEquations& n) {
        const float least = 1e-9F;
        d0 = n.m00.max(least);
        l10 = n.m10 / d0;
        l20 = n.m20 / d0;
        l30 = n.m30 / d0;
        d1 = (n.m11 - l10 * n.m10).max(least);
        const Lane e21 = n.m21 - l20 * n.m10, e31 = n.m31 - l30 * n.m10;
        l21 = e21 / d1;
        l31 = e31 / d1;
        d2 = (n.m22 - l20 * n.m20 - l21 * e21).max(least);
        const Lane e32 = n.m32 - l30 * n.m20 - l31 * e21;
        l32 = e32 / d2;
        d3 = (n.m33 - l30 * n.m30 - l31 * e31 - l32 * e32).max(least);
    }
    /// Of the row: the diagonal of the inverse there, 1 / d2 + l32^2 / d3.
    Lane variance_of_row() const { return 1 / d2 + l32.square() / d3; }
};

struct Model {
    Lane a, step, row, slope;

    void change_by(const NormalEquations& n, const Factor& f) {
        const Lane y1 = n.r1 - f.l10 * n.r0, y2 = n.r2 - f.l20 * n.r0 - f.l21 * y1;
        const Lane x3 = (n.r3 - f.l30 * n.r0 - f.l31 * y1 - f.l32 * y2) / f.d3;
        const Lane x2 = y2 / f.d2 - f.l32 * x3;
        const Lane x1 = y1 / f.d1 - f.l21 * x2 - f.l31 * x3;
        a += n.r0 / f.d0 - f.l10 * x1 - f.l20 * x2 - f.l30 * x3;
        step += x1;
        row += x2.max(-1).min(1);
        slope += x3;
    }
};

/// Eight windows of pixels, rows counted from the place; weights are 0 beyond the frame.
struct Windows {
    Lane grey[num_rows], weight[num_rows], width;

    Windows(std::span<const EdgePlace> places, Index rows) {
        for (Index lane = 0; lane < lanes; ++lane) {
            const EdgePlace& place = places[std::min<std::size_t>(lane, places.size() - 1)];
            width[lane] = place.width;
            for (Index k = 0; k < num_rows; ++k) {
                const Index y = place.row + k - half_rows;
                const bool is_seen = y >= 0 && y < rows;
                weight[k][lane] = is_seen ? 1 : 0;
                grey[k][lane] = is_seen ? place.column[y] : 0;
            }
        }
    }
    /// Of the rows from the third behind the edge on.
    Lane brightness() const {
        Lane sum = Lane::Zero(), count = Lane::Zero();
        for (Index k = half_rows + 2; k < num_rows; ++k) {
            sum += grey[k];
            count += weight[k];
        }
        return sum / count.max(1);
    }
};

// Phi(t), for t >= 0: 1 - density (b1 k + ... + b5 k^5), k = 1 / (1 + 0.2316419 t), to 7.5e-8
// (Abramowitz and Stegun, 26.2.17)
Lane normal_below(const Lane& t, const Lane& density) {
    const Lane k = 1 / (1 + 0.2316419F * t.abs());
    const Lane above =
        density * k *
        (0.319381530F +
         k * (-0.356563782F + k * (1.781477937F + k * (-1.821255978F + k * 1.330274429F))));
    return (t < 0).select(above, 1 - above);
}

struct Residuals {
    Lane squares = Lane::Zero(), slope_of_width = Lane::Zero(), weight_of_width = Lane::Zero(),
         count = Lane::Zero();
};

/// With the priors of a and d.
NormalEquations equations(const Windows& windows, const Model& model, float noise,
                          Residuals& residuals) {
    const float noise2 = noise * noise, dark_weight = noise2 / (dark_sd * dark_sd);
    const Lane slope_weight = noise2 / ((slope_part * model.step).square() + 1e-6F);
    NormalEquations n;
    n.m00 = Lane::Constant(dark_weight);
    n.r0 = -dark_weight * model.a;
    n.m33 = slope_weight;
    n.r3 = -slope_weight * model.slope;
    for (Lane* zero :
         {&n.m10, &n.m11, &n.m20, &n.m21, &n.m22, &n.m30, &n.m31, &n.m32, &n.r1, &n.r2})
        zero->setZero();
    residuals = {};
    const Lane per_width = 1 / windows.width;
    for (Index k = 0; k < num_rows; ++k) {
        const Lane& w = windows.weight[k];
        const Lane away = float(k - half_rows) - model.row, t = away * per_width;
        const Lane density = 0.39894228F * (-0.5F * t.square()).exp();
        const Lane phi = normal_below(t, density);
        const Lane beyond = away.max(0);
        const Lane difference =
            w * (windows.grey[k] - (model.a + model.step * phi + model.slope * beyond));
        const Lane of_row =
            -model.step * density * per_width - (away > 0).select(model.slope, Lane::Zero());
        const Lane w_phi = w * phi, w_row = w * of_row, w_beyond = w * beyond;
        n.m00 += w;
        n.m10 += w_phi;
        n.m11 += w_phi * phi;
        n.m20 += w_row;
        n.m21 += w_row * phi;
        n.m22 += w_row * of_row;
        n.m30 += w_beyond;
        n.m31 += w_beyond * phi;
        n.m32 += w_beyond * of_row;
        n.m33 += w_beyond * beyond;
        n.r0 += difference;
        n.r1 += difference * phi;
        n.r2 += difference * of_row;
        n.r3 += difference * beyond;
        const Lane by_width = -w * model.step * density * t;
        residuals.squares += difference.square();
        residuals.slope_of_width += difference * by_width;
        residuals.weight_of_width += by_width.square();
        residuals.count += w;
    }
    return n;
}

PALPATE_MULTIVERSION PALPATE_FLATTEN void fit_eight(std::span<const EdgePlace> places, Index rows,
                                                    float noise, std::span<FittedEdge> edges) {
    constexpr float begin = -0.5F;
    const Windows windows(places, rows);
    Model model{Lane::Zero(), windows.brightness(), Lane::Constant(begin), Lane::Zero()};
    Residuals residuals;
    for (int round = 0; round < iterations; ++round) {
        const NormalEquations normal = equations(windows, model, noise, residuals);
        model.change_by(normal, Factor(normal));
    }
    const Factor factor(equations(windows, model, noise, residuals));
    const Lane variance = residuals.squares / (residuals.count - 3).max(1);
    const Lane sd = (factor.variance_of_row() * variance.max(noise * noise)).sqrt();
    for (std::size_t k = 0; k < places.size(); ++k) {
        const auto lane = Index(k);
        const bool is_fitted = std::abs(model.row[lane] - begin) < farthest &&
                               model.step[lane] > 0 && std::isfinite(sd[lane]);
        edges[k] = {.row = float(places[k].row) + (is_fitted ? model.row[lane] : begin),
                    .sd = is_fitted ? sd[lane] : no_sd,
                    .step = model.step[lane],
                    .variance = variance[lane],
                    .slope_of_width = residuals.slope_of_width[lane],
                    .weight_of_width = residuals.weight_of_width[lane]};
    }
}

}  // namespace

void fit_edges(std::span<const EdgePlace> places, Index rows, float noise,
               std::span<FittedEdge> edges) {
    for (std::size_t k = 0; k < places.size(); k += lanes) {
        const std::size_t count = std::min<std::size_t>(lanes, places.size() - k);
        fit_eight(places.subspan(k, count), rows, noise, edges.subspan(k, count));
    }
}

}  // namespace palpate
