// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "host/apps/aspirate/contours/outline_search.hpp"

namespace palpate {
namespace {

constexpr Index width = 5, rows = 6;
constexpr float weight = 1.5F, curvature = 0.5F;

OutlineSearch random_search(unsigned seed) {
    OutlineSearch search(width, rows);
    std::mt19937 engine(seed);
    for (Index x = 0; x < width; ++x)
        for (Index y = 0; y < rows; ++y)
            search.cost()[x * search.stride() + y] = float(engine() % 1000) / 100;
    search.set_bend(std::vector<float>(width, 0.0F), weight, curvature);
    return search;
}

/// Every path of five columns, tried; the least cost of those through row `y` of column `at`.
float least_through(OutlineSearch& search, Index at, Index y) {
    float least = std::numeric_limits<float>::max();
    for (int code = 0; code < std::pow(rows, width); ++code) {
        float sum = 0;
        Index last = -1, rest = code;
        bool is_allowed = true;
        for (Index x = 0; x < width; ++x, rest /= rows) {
            const Index row = rest % rows;
            if (x == at && row != y) is_allowed = false;
            const float k = x ? std::abs(float(row - last)) : 0;
            if (k > OutlineSearch::reach) is_allowed = false;
            sum += search.cost()[x * search.stride() + row] + weight * (k + curvature * k * k);
            last = row;
        }
        if (is_allowed) least = std::min(least, sum);
    }
    return least;
}

TEST(OutlineSearch, FindsTheBestOfAllPathsAndHowMuchWorseOthersAre) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        OutlineSearch search = random_search(seed);
        search.run();
        std::vector<float> margin(width);
        search.margins(1, margin);
        for (Index x = 0; x < width; ++x) {
            const Index best = search.path()[x];
            float other = std::numeric_limits<float>::max();
            for (Index y = 0; y < rows; ++y) {
                EXPECT_LE(least_through(search, x, best), least_through(search, x, y) + 1e-4F);
                if (std::abs(y - best) > 1) other = std::min(other, least_through(search, x, y));
            }
            EXPECT_NEAR(margin[x], other - least_through(search, x, best), 1e-3);
        }
    }
}

}  // namespace
}  // namespace palpate
