// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/column_loops.hpp"

#include <cmath>
#include <cstring>

#include "solver/base/multiversion.hpp"

namespace palpate {
namespace {

// Least-squares derivative of seven taps (Vuskovic and Kauer), as correlation weights
constexpr float tap1 = 0.833812F, tap2 = -0.229945F, tap3 = 0.0420264F;
constexpr float half1 = tap1 / 2, half12 = (tap1 + tap2) / 2, half23 = (tap2 + tap3) / 2,
                half3 = tap3 / 2;

/// Four rows of four pixels to four columns.
void turn_four(const float* rows, Index width, float* columns, Index stride) {
    using Four = float __attribute__((vector_size(16)));
    Four r[4];
    for (Index k = 0; k < 4; ++k) std::memcpy(&r[k], rows + k * width, sizeof(Four));
    const Four low0 = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
               high0 = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7),
               low1 = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5),
               high1 = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
    const Four c[4] = {__builtin_shufflevector(low0, low1, 0, 1, 4, 5),
                       __builtin_shufflevector(low0, low1, 2, 3, 6, 7),
                       __builtin_shufflevector(high0, high1, 0, 1, 4, 5),
                       __builtin_shufflevector(high0, high1, 2, 3, 6, 7)};
    for (Index k = 0; k < 4; ++k) std::memcpy(columns + k * stride, &c[k], sizeof(Four));
}

}  // namespace

void turn_columns(const float* frame, Index width, Index end, Index stride, float* columns) {
    Index y = 0;
    for (; y + 4 <= end; y += 4) {
        Index x = 0;
        for (; x + 4 <= width; x += 4)
            turn_four(frame + y * width + x, width, columns + x * stride + y, stride);
        for (; x < width; ++x)
            for (Index row = y; row < y + 4; ++row)
                columns[x * stride + row] = frame[row * width + x];
    }
    for (; y < end; ++y)
        for (Index x = 0; x < width; ++x) columns[x * stride + y] = frame[y * width + x];
}

PALPATE_MULTIVERSION
void take_background(const float* grey, const float* p, Index end, float* residual, float* sum) {
    const float p0 = p[0], p1 = p[1], p2 = p[2];
    for (Index y = 0; y < end; ++y) {
        const float row = float(int(y));
        residual[y] = grey[y] - (p0 + row * (p1 + row * p2));
    }
    sum[0] = 1.5F * (residual[0] + residual[1]);
    for (Index y = 1; y < end - 1; ++y) sum[y] = residual[y - 1] + residual[y] + residual[y + 1];
}

PALPATE_MULTIVERSION
void mean_of_nine(const float* left, const float* middle, const float* right, Index end,
                  float* mean) {
    for (Index y = 0; y < end; ++y) mean[y] = (left[y] + middle[y] + right[y]) * (1.0F / 9);
}

PALPATE_MULTIVERSION
void pixel_evidence(const float* smooth, const EvidenceScales& scales, Index end, float* evidence) {
    const float per_sigma = 1 / scales.sigma, per_sd = 1 / scales.sd, tissue = scales.tissue;
    const float most = scales.most, least = -scales.least, factor = scales.factor;
    const float width_term = 0.5F * std::log(scales.sd / scales.sigma);
    for (Index y = 0; y < end; ++y) {
        const float d = smooth[y] * per_sigma, t = (smooth[y] - tissue) * per_sd;
        const float from_background = 0.5F * d * d, from_tissue = 0.5F * t * t;
        float e = (from_background < 8 ? from_background : 8) -
                  (from_tissue < 4 ? from_tissue : 4) - width_term;
        e = e < most ? e : most;
        evidence[y] = factor * (e > least ? e : least);
    }
}

void sum_before(const float* evidence, Index end, float* cost) {
    // Sums of four at a time, so that one addition in four waits for the one before
    float sum = 0;
    Index y = 0;
    for (; y + 4 <= end; y += 4) {
        const float a = evidence[y], b = a + evidence[y + 1], c = b + evidence[y + 2];
        cost[y] = sum;
        cost[y + 1] = sum + a;
        cost[y + 2] = sum + b;
        cost[y + 3] = sum + c;
        sum += c + evidence[y + 3];
    }
    for (; y < end; ++y) {
        cost[y] = sum;
        sum += evidence[y];
    }
    cost[end] = sum;
}

PALPATE_MULTIVERSION
void reward_steps(const float* residual, const StepRewards& rewards, Index end, float* sums,
                  float* cost) {
    const auto [per_step, most_step, per_slope, most_slope] = rewards;
    const float* r = residual;
    for (Index y = 0; y < end; ++y) sums[y] = r[y] + r[y + 1] + r[y + 2] + r[y + 3] + r[y + 4];
    for (Index y = step_rows; y < end - 2; ++y) {
        const float step = sums[y] - sums[y - step_rows];
        // the mean of the derivatives at rows y - 1 and y
        const float slope = half1 * (r[y] - r[y - 1]) + half12 * (r[y + 1] - r[y - 2]) +
                            half23 * (r[y + 2] - r[y - 3]) + half3 * (r[y + 3] - r[y - 4]);
        float a = step * per_step, b = slope * per_slope;
        a = a > 0 ? a : 0;
        b = b > 0 ? b : 0;
        cost[y] -= (a < most_step ? a : most_step) + (b < most_slope ? b : most_slope);
    }
}

PALPATE_MULTIVERSION
void add_jumps(float expected, float weight, float most, Index end, float* cost) {
    for (Index y = 0; y <= end; ++y) {
        const float row = float(int(y));
        const float away = row < expected ? expected - row : row - expected;
        cost[y] += weight * (away < most ? away : most);
    }
}

}  // namespace palpate
