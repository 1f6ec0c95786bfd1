// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/multigrid/block_kernels.hpp"

#include <algorithm>

#include "solver/base/multiversion.hpp"

// The loops are templates over the block size; one plain function per size and loop carries the
// processor versions.
#define PALPATE_ALWAYS_INLINE inline __attribute__((always_inline))

namespace palpate {
namespace {

constexpr int modes_per_node = 6;

/// c += alpha a b with a [M, K], b [K, modes_per_node], c [M, modes_per_node].
template <int M, int K>
PALPATE_ALWAYS_INLINE void add_product(double alpha, const double* a, const double* b, double* c) {
    for (int i = 0; i < M; ++i)
        for (int k = 0; k < K; ++k) {
            const double aik = alpha * a[K * i + k];
            for (int j = 0; j < modes_per_node; ++j)
                c[modes_per_node * i + j] += aik * b[modes_per_node * k + j];
        }
}

/// c += a^T b with a [M, modes_per_node], b [M, modes_per_node], c [modes_per_node,
/// modes_per_node].
template <int M>
PALPATE_ALWAYS_INLINE void add_transposed_product(const double* a, const double* b, double* c) {
    for (int k = 0; k < M; ++k)
        for (int i = 0; i < modes_per_node; ++i) {
            const double aki = a[modes_per_node * k + i];
            for (int j = 0; j < modes_per_node; ++j)
                c[modes_per_node * i + j] += aki * b[modes_per_node * k + j];
        }
}

/// Entry of a short ascending list.
PALPATE_ALWAYS_INLINE Index find_entry(const Adjacency& graph, Index row, Index column) {
    Index k = graph.offsets[row];
    while (graph.items[k] != column) ++k;
    return k;
}

template <int B>
PALPATE_ALWAYS_INLINE void multiply_rows_of(const BlockMatrix& a, Index first, Index last,
                                            const double* x, double* y) {
    for (Index n = first; n < last; ++n) {
        double sum[B] = {};
        for (Index k = a.graph.offsets[n]; k < a.graph.offsets[n + 1]; ++k) {
            const double* block = a.blocks.data() + static_cast<std::size_t>(k) * B * B;
            const double* xn = x + static_cast<std::size_t>(a.graph.items[k]) * B;
            for (int i = 0; i < B; ++i)
                for (int j = 0; j < B; ++j) sum[i] += block[B * i + j] * xn[j];
        }
        std::copy(sum, sum + B, y + static_cast<std::size_t>(n) * B);
    }
}

template <int B>
PALPATE_ALWAYS_INLINE void smooth_rows_of(const BlockMatrix& a, Index first, Index last,
                                          const double* inverse_diagonal, double omega,
                                          const Index* of_node, const double* tentative,
                                          BlockMatrix& p) {
    constexpr std::size_t size = B * modes_per_node;
    for (Index n = first; n < last; ++n) {
        const Index begin = p.graph.offsets[n], end = p.graph.offsets[n + 1];
        if (begin == end) continue;
        double* row = p.blocks.data() + size * begin;
        double unsmoothed[size];
        for (Index entry = begin; entry < end; ++entry, row += size) {
            const Index aggregate = p.graph.items[entry];
            std::fill(unsmoothed, unsmoothed + size, 0.0);
            for (Index k = a.graph.offsets[n]; k < a.graph.offsets[n + 1]; ++k) {
                const Index other = a.graph.items[k];
                if (of_node[other] == aggregate)
                    add_product<B, B>(1.0, a.blocks.data() + static_cast<std::size_t>(k) * B * B,
                                      tentative + size * other, unsmoothed);
            }
            std::fill(row, row + size, 0.0);
            if (of_node[n] == aggregate)
                std::copy(tentative + size * n, tentative + size * (n + 1), row);
            add_product<B, B>(-omega, inverse_diagonal + static_cast<std::size_t>(n) * B * B,
                              unsmoothed, row);
        }
    }
}

template <int B>
PALPATE_ALWAYS_INLINE void prolongation_product_of(const BlockMatrix& a, const BlockMatrix& p,
                                                   Index first, Index last, BlockMatrix& c) {
    constexpr std::size_t size = B * modes_per_node;
    for (Index n = first; n < last; ++n) {
        const Index begin = c.graph.offsets[n], end = c.graph.offsets[n + 1];
        if (begin == end) continue;
        std::fill(c.blocks.data() + size * begin, c.blocks.data() + size * end, 0.0);
        for (Index k = a.graph.offsets[n]; k < a.graph.offsets[n + 1]; ++k) {
            const double* block = a.blocks.data() + static_cast<std::size_t>(k) * B * B;
            const Index other = a.graph.items[k];
            for (Index q = p.graph.offsets[other]; q < p.graph.offsets[other + 1]; ++q)
                add_product<B, B>(
                    1.0, block, p.blocks.data() + size * q,
                    c.blocks.data() + size * find_entry(c.graph, n, p.graph.items[q]));
        }
    }
}

template <int B>
PALPATE_ALWAYS_INLINE void restriction_product_of(const BlockMatrix& p, const Adjacency& members,
                                                  const Index* entries, const BlockMatrix& c,
                                                  Index first, Index last, BlockMatrix& coarse) {
    constexpr std::size_t size = B * modes_per_node;
    constexpr std::size_t coarse_size = modes_per_node * modes_per_node;
    std::vector<Index> position(coarse.num_columns, -1);
    for (Index row = first; row < last; ++row) {
        const Index begin = coarse.graph.offsets[row], end = coarse.graph.offsets[row + 1];
        for (Index k = begin; k < end; ++k) position[coarse.graph.items[k]] = k;
        std::fill(coarse.blocks.data() + coarse_size * begin,
                  coarse.blocks.data() + coarse_size * end, 0.0);
        for (Index m = members.offsets[row]; m < members.offsets[row + 1]; ++m) {
            const Index node = members.items[m];
            const double* left = p.blocks.data() + size * entries[m];
            for (Index q = c.graph.offsets[node]; q < c.graph.offsets[node + 1]; ++q)
                if (c.graph.items[q] >= row)
                    add_transposed_product<B>(
                        left, c.blocks.data() + size * q,
                        coarse.blocks.data() + coarse_size * position[c.graph.items[q]]);
        }
    }
}

PALPATE_MULTIVERSION
void multiply_rows_3(const BlockMatrix& a, Index first, Index last, const double* x, double* y) {
    multiply_rows_of<3>(a, first, last, x, y);
}
PALPATE_MULTIVERSION
void multiply_rows_6(const BlockMatrix& a, Index first, Index last, const double* x, double* y) {
    multiply_rows_of<6>(a, first, last, x, y);
}
PALPATE_MULTIVERSION
void smooth_rows_3(const BlockMatrix& a, Index first, Index last, const double* d, double omega,
                   const Index* of_node, const double* t, BlockMatrix& p) {
    smooth_rows_of<3>(a, first, last, d, omega, of_node, t, p);
}
PALPATE_MULTIVERSION
void smooth_rows_6(const BlockMatrix& a, Index first, Index last, const double* d, double omega,
                   const Index* of_node, const double* t, BlockMatrix& p) {
    smooth_rows_of<6>(a, first, last, d, omega, of_node, t, p);
}
PALPATE_MULTIVERSION
void prolongation_product_3(const BlockMatrix& a, const BlockMatrix& p, Index first, Index last,
                            BlockMatrix& c) {
    prolongation_product_of<3>(a, p, first, last, c);
}
PALPATE_MULTIVERSION
void prolongation_product_6(const BlockMatrix& a, const BlockMatrix& p, Index first, Index last,
                            BlockMatrix& c) {
    prolongation_product_of<6>(a, p, first, last, c);
}
PALPATE_MULTIVERSION
void restriction_product_3(const BlockMatrix& p, const Adjacency& members, const Index* entries,
                           const BlockMatrix& c, Index first, Index last, BlockMatrix& coarse) {
    restriction_product_of<3>(p, members, entries, c, first, last, coarse);
}
PALPATE_MULTIVERSION
void restriction_product_6(const BlockMatrix& p, const Adjacency& members, const Index* entries,
                           const BlockMatrix& c, Index first, Index last, BlockMatrix& coarse) {
    restriction_product_of<6>(p, members, entries, c, first, last, coarse);
}

}  // namespace

void multiply_block_rows(const BlockMatrix& a, Index first, Index last, const double* x,
                         double* y) {
    (a.block_rows == 3 ? multiply_rows_3 : multiply_rows_6)(a, first, last, x, y);
}

void smooth_prolongation(const BlockMatrix& a, Index first, Index last,
                         const double* inverse_diagonal, double omega, const Index* of_node,
                         const double* tentative, BlockMatrix& p) {
    (a.block_rows == 3 ? smooth_rows_3 : smooth_rows_6)(a, first, last, inverse_diagonal, omega,
                                                        of_node, tentative, p);
}

void multiply_prolongation(const BlockMatrix& a, const BlockMatrix& p, Index first, Index last,
                           BlockMatrix& c) {
    (a.block_rows == 3 ? prolongation_product_3 : prolongation_product_6)(a, p, first, last, c);
}

void mirror_upper_triangle(BlockMatrix& matrix, Index first, Index last) {
    const int b = matrix.block_rows;
    for (Index row = first; row < last; ++row)
        for (Index k = matrix.graph.offsets[row]; k < matrix.graph.offsets[row + 1]; ++k) {
            const Index column = matrix.graph.items[k];
            if (column >= row) break;
            const auto begin = matrix.graph.items.begin();
            const auto entry = std::lower_bound(begin + matrix.graph.offsets[column],
                                                begin + matrix.graph.offsets[column + 1], row);
            const double* from = matrix.block(static_cast<Index>(entry - begin));
            double* to = matrix.block(k);
            for (int i = 0; i < b; ++i)
                for (int j = 0; j < b; ++j) to[b * i + j] = from[b * j + i];
        }
}

void multiply_restriction(const BlockMatrix& p, const Adjacency& members, const Index* entries,
                          const BlockMatrix& c, Index first, Index last, BlockMatrix& coarse) {
    (p.block_rows == 3 ? restriction_product_3 : restriction_product_6)(p, members, entries, c,
                                                                        first, last, coarse);
}

}  // namespace palpate
