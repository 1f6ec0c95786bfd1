// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "solver/backends/kokkos/column_sweep.hpp"
#include "solver/model/solid_element.hpp"

// Loops over the elements of one law. Each writes the results of its elements; `GatherRows` adds
// them up at nodes or blocks in a fixed order.
namespace palpate {

/// The mesh on the device and the elements of one law, whose materials are `laws` [materials].
template <class Law>
struct LawLoop {
    using Real = typename Law::Number;

    const Law* laws;
    const Index* list;  ///< the elements of this law
    const Index* elements;
    const Index* region;
    const Real* points;
    SolidLayout layout;

    KOKKOS_INLINE_FUNCTION std::int64_t number(std::int64_t work) const { return list[work]; }
    KOKKOS_INLINE_FUNCTION const Law& law(std::int64_t e) const { return laws[region[e]]; }
    KOKKOS_INLINE_FUNCTION SolidElement<Real> element(std::int64_t e) const {
        return {elements + e * layout.num_nodes,
                points + e * layout.num_points * layout.reals_per_point(), layout};
    }
};

/// energy [num_elements], force [num_elements, nodes, 3]
template <class Law>
struct ForceLoop {
    LawLoop<Law> loop;
    const typename Law::Number* u;
    typename Law::Number* energy;
    typename Law::Number* force;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t work) const {
        const std::int64_t e = loop.number(work);
        energy[e] =
            element_force(loop.law(e), loop.element(e), u, force + 3 * loop.layout.num_nodes * e);
    }
};

/// blocks [num_elements, nodes, nodes, 3, 3]
template <class Law>
struct TangentLoop {
    LawLoop<Law> loop;
    const typename Law::Number* u;
    typename Law::Number* blocks;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t work) const {
        const std::int64_t e = loop.number(work);
        const std::int64_t size = 9 * loop.layout.num_nodes * loop.layout.num_nodes;
        element_tangent(loop.law(e), loop.element(e), u, blocks + size * e);
    }
};

/// forces [num_elements, nodes, 3, columns] of K(u) x
template <class Law>
struct ProductLoop {
    LawLoop<Law> loop;
    const typename Law::Number* u;
    const typename Law::Number* x;
    std::int64_t columns;
    typename Law::Number* forces;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t work) const {
        const std::int64_t e = loop.number(work);
        element_product(loop.law(e), loop.element(e), u, x, columns,
                        forces + 3 * loop.layout.num_nodes * columns * e);
    }
};

/// parts [num_elements, stride] of lambda . df/dp for the law's `count` parameters
template <class Law>
struct ParameterLoop {
    LawLoop<Law> loop;
    const typename Law::Number* u;
    const typename Law::Number* lambda;
    int count;
    int stride;
    typename Law::Number* parts;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t work) const {
        const std::int64_t e = loop.number(work);
        for (int k = 0; k < count; ++k)
            parts[e * stride + k] =
                element_parameter_product(loop.law(e), loop.element(e), u, lambda, k);
    }
};

/// to[row, :] = sum of from[items, :] over the list of each row, in its order; rows of `width`.
template <typename Real>
struct GatherRows {
    const Index* offsets;
    const Index* items;
    const Real* from;
    Real* to;
    std::int64_t width;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row) const {
        Real* const sum = to + row * width;
        for (std::int64_t i = 0; i < width; ++i) sum[i] = 0;
        for (Index k = offsets[row]; k < offsets[row + 1]; ++k) {
            const Real* const part = from + items[k] * width;
            for (std::int64_t i = 0; i < width; ++i) sum[i] += part[i];
        }
    }
};

}  // namespace palpate
