// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/still_things.hpp"

#include <algorithm>

#include "solver/base/multiversion.hpp"

namespace palpate {
namespace {

constexpr float least_share = 0.05F;   // of a frame in the mean: what is older fades
constexpr float seen_sigmas = 5;       // a thing differs so much from the background
constexpr float changed_sigmas = 5;    // and shows no more where it differs so much from itself
constexpr float changed_part = 0.15F;  // or by this part of its brightness

}  // namespace

StillThings::StillThings(Index width, Index rows, Index stride)
    : width_(width),
      rows_(rows),
      stride_(stride),
      mean_(std::size_t(width * stride), 0.0F),
      share_(std::size_t(width * stride), 1.0F) {}

PALPATE_MULTIVERSION
void StillThings::learn(const std::vector<float>& smooth, const std::vector<float>& top) {
    for (Index x = 0; x < width_; ++x) {
        const Index end = std::clamp<Index>(Index(top[x]), 0, rows_);
        float* mean = &mean_[x * stride_];
        float* share = &share_[x * stride_];
        const float* now = &smooth[x * stride_];
        for (Index y = 0; y < end; ++y) {
            mean[y] += share[y] * (now[y] - mean[y]);
            const float next = share[y] / (1 + share[y]);
            share[y] = next < least_share ? least_share : next;
        }
    }
}

PALPATE_MULTIVERSION
void StillThings::hush(Index x, const float* smooth, float sigma, float* evidence) const {
    const float* mean = &mean_[x * stride_];
    const float seen = seen_sigmas * sigma, changed = changed_sigmas * sigma;
    for (Index y = 0; y < rows_; ++y) {
        const float size = mean[y] < 0 ? -mean[y] : mean[y];
        const float difference = smooth[y] - mean[y];
        const float away = difference < 0 ? -difference : difference;
        const float allowed = changed + changed_part * size;
        const bool is_still = (size > seen) & (away < allowed);
        evidence[y] = is_still ? 0 : evidence[y];
    }
}

}  // namespace palpate
