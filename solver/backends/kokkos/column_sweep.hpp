// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "solver/backends/kokkos/device_arrays.hpp"
#include "solver/backends/kokkos/lanes.hpp"
#include "solver/base/multiversion.hpp"

// How loops over [items, columns] are cut for any execution space, and how they sum.
//
// A body is a copyable struct of arrays and numbers with
//   static constexpr Index part_length    items of one part on a host
//   template <int width> KOKKOS_INLINE_FUNCTION
//   void run(Index first, Index last, Index column, Lanes<double, width>& sums) const
// that handles items [first, last) for the columns [column, column + width) and may add to the sums
// of those columns. On a host one thread takes a part, 128 bytes of neighbouring columns at a time,
// which the compiler turns into vector instructions; on a GPU neighbouring threads take
// neighbouring columns. The cut depends on the sizes alone, and so do the bits of every sum.
namespace palpate {

/// Partial sums: parts of a sweep, then groups of parts, then one number per column.
class SumBuffers {
public:
    /// Room for [parts, columns]; kept until more is wanted.
    const Array<double>& room(int level, std::size_t size) {
        Array<double>& buffer = levels_[level % 2];
        if (buffer.size() < size) buffer = make_array<double>(size);
        return buffer;
    }

private:
    Array<double> levels_[2];
};

/// One part on a host, with the vector instructions of the processor it runs on.
template <int width, typename Body>
PALPATE_MULTIVERSION PALPATE_FLATTEN void run_on_host(const Body& body, Index first, Index last,
                                                      Index column, Lanes<double, width>& sums) {
    const Body local = body;  // the compiler then knows that no result changes it
    local.template run<width>(first, last, column, sums);
}

template <typename Body, typename Real>
struct ColumnSweep {
    static constexpr int tile = runs_on_host ? 128 / static_cast<int>(sizeof(Real)) : 1;
    static constexpr Index part_length =
        runs_on_host ? Body::part_length : (Body::part_length + 7) / 8;

    Body body;
    Index items;
    Index columns;
    Index tiles;
    double* partial;  ///< [parts, columns] on the device, or null: no sums wanted

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t work) const {
        const Index part = static_cast<Index>(work / tiles);
        const Index column = static_cast<Index>(work % tiles) * tile;
        run_columns<tile>(part, column, column + tile < columns ? column + tile : columns);
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void run_columns(Index part, Index column, Index end) const {
        const Index first = part * part_length;
        const Index last = items - first < part_length ? items : first + part_length;
        for (; column + width <= end; column += width) {
            Lanes<double, width> sums;
            sums.clear();
            if constexpr (runs_on_host)
                run_on_host<width>(body, first, last, column, sums);
            else
                body.template run<width>(first, last, column, sums);
            if (partial) sums.store(partial + static_cast<std::int64_t>(part) * columns + column);
        }
        if constexpr (width > 1) run_columns<width / 2>(part, column, end);
    }
};

/// out[g, c] = sum of up to group_length parts in[p, c], in their order.
struct SumParts {
    static constexpr Index group_length = 256;

    const double* in;
    double* out;
    Index parts;
    Index columns;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t work) const {
        const Index first = static_cast<Index>(work / columns) * group_length;
        const Index last = parts - first < group_length ? parts : first + group_length;
        double sum = 0;
        for (std::int64_t p = first; p < last; ++p) sum += in[p * columns + work % columns];
        out[work] = sum;
    }
};

template <typename Functor>
void for_each_work(std::int64_t count, const Functor& functor) {
    Kokkos::parallel_for(
        "palpate", Kokkos::RangePolicy<KokkosSpace, Kokkos::IndexType<std::int64_t>>(0, count),
        functor);
}

inline void sum_parts(Index parts, SumBuffers& buffers, KokkosSums& sums) {
    const Index columns = sums.columns();
    if (parts == 0) Kokkos::deep_copy(sums.values, 0.0);
    for (int level = 0; parts > 0; ++level) {
        const Index groups = (parts + SumParts::group_length - 1) / SumParts::group_length;
        const std::size_t size = static_cast<std::size_t>(groups) * columns;
        double* in = buffers.room(level, 0).data();
        double* out = groups == 1 ? sums.values.data() : buffers.room(level + 1, size).data();
        for_each_work(static_cast<std::int64_t>(size), SumParts{in, out, parts, columns});
        if (groups == 1) return;
        parts = groups;
    }
}

/// Runs `body` for all items and columns; `sums`, if given, receives what it added up.
template <typename Real, typename Body>
void sweep(const Body& body, Index items, Index columns, SumBuffers& buffers,
           KokkosSums* sums = nullptr) {
    using Sweep = ColumnSweep<Body, Real>;
    const Index parts = (items + Sweep::part_length - 1) / Sweep::part_length;
    const Index tiles = (columns + Sweep::tile - 1) / Sweep::tile;
    double* partial =
        sums ? buffers.room(0, static_cast<std::size_t>(parts) * columns).data() : nullptr;
    for_each_work(static_cast<std::int64_t>(parts) * tiles,
                  Sweep{body, items, columns, tiles, partial});
    if (sums) sum_parts(parts, buffers, *sums);
}

}  // namespace palpate
