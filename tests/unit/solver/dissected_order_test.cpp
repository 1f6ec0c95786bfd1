// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/dissected_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

namespace palpate {
namespace {

using Lower = Eigen::SparseMatrix<double>;

/// Pattern of `size`^3 nodes of three rows each, every node coupled to the next along each axis.
Lower lattice(int size) {
    const auto node = [&](int x, int y, int z) { return x + size * (y + size * z); };
    std::vector<Eigen::Triplet<double>> entries;
    const auto couple = [&](int a, int b) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (3 * b + i >= 3 * a + j) entries.emplace_back(3 * b + i, 3 * a + j, 1.0);
    };
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const int here = node(x, y, z);
                couple(here, here);
                if (x + 1 < size) couple(here, node(x + 1, y, z));
                if (y + 1 < size) couple(here, node(x, y + 1, z));
                if (z + 1 < size) couple(here, node(x, y, z + 1));
            }
    Lower lower(3 * size * size * size, 3 * size * size * size);
    lower.setFromTriplets(entries.begin(), entries.end());
    return lower;
}

/// Entries of the Cholesky factor for that order, by elimination of one row after the other.
std::size_t entries_of_factor(const Lower& lower, const std::vector<int>& order) {
    std::vector<std::set<int>> below(order.size());
    for (int j = 0; j < lower.outerSize(); ++j)
        for (Lower::InnerIterator it(lower, j); it; ++it) {
            const auto [first, last] = std::minmax(order[j], order[it.row()]);
            if (first != last) below[first].insert(last);
        }
    std::size_t entries = order.size();
    for (const auto& rows : below) {
        entries += rows.size();
        if (rows.empty()) continue;
        auto& next = below[*rows.begin()];
        next.insert(std::next(rows.begin()), rows.end());
    }
    return entries;
}

std::vector<int> natural_order(const Lower& lower) {
    std::vector<int> order(lower.rows());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    return order;
}

TEST(DissectedOrder, TakesEveryPlaceOnceAndKeepsTheRowsOfANodeTogether) {
    const Lower lower = lattice(7);

    const std::vector<int> order = dissected_order(lower);

    std::vector<int> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, natural_order(lower));
    for (std::size_t i = 0; i < order.size(); i += 3) {
        EXPECT_EQ(order[i + 1], order[i] + 1);
        EXPECT_EQ(order[i + 2], order[i] + 2);
    }
}

TEST(DissectedOrder, FillsLessThanHalfOfWhatABandDoes) {
    const Lower lower = lattice(10);

    EXPECT_LT(entries_of_factor(lower, dissected_order(lower)),
              entries_of_factor(lower, natural_order(lower)) / 2);
}

TEST(DissectedOrder, IsTheSameOnEveryCall) {
    const Lower lower = lattice(12), other = lattice(9);
    const std::vector<int> first = dissected_order(lower);

    dissected_order(other);

    EXPECT_EQ(dissected_order(lower), first);
}

TEST(DissectedOrder, TakesMatricesWithoutCouplings) {
    for (int n : {1, 2, 200}) {
        Lower diagonal(n, n);
        diagonal.setIdentity();

        std::vector<int> order = dissected_order(diagonal);

        std::sort(order.begin(), order.end());
        EXPECT_EQ(order, natural_order(diagonal));
    }
}

}  // namespace
}  // namespace palpate
