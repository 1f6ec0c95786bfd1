// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <string>

#include "solver/backend/device_operator.hpp"
#include "solver/backend/device_vector.hpp"
#include "solver/backend/own_argument.hpp"
#include "solver/backends/kokkos/session.hpp"
#include "solver/base/error.hpp"

namespace palpate {

template <typename T>
using Array = Kokkos::View<T*, KokkosSpace>;
template <typename T>
using ConstArray = Kokkos::View<const T*, KokkosSpace>;

/// Uninitialised; NaN in debug builds, so that tests find what nobody wrote.
template <typename T>
Array<T> make_array(std::size_t size) {
    Array<T> array;
    try {
        array = Array<T>(Kokkos::view_alloc("palpate", Kokkos::WithoutInitializing), size);
    } catch (const std::exception&) {
        throw Error(ErrorCode::out_of_memory, "Back end kokkos has no room for " +
                                                  std::to_string(size * sizeof(T) / 1000000) +
                                                  " MB; use fewer columns or a coarser mesh.");
    }
#ifndef NDEBUG
    if constexpr (std::is_floating_point_v<T>)
        Kokkos::deep_copy(array, std::numeric_limits<T>::quiet_NaN());
#endif
    return array;
}

/// Host numbers to an array of the same size, rounded to its type.
template <typename T, typename Source>
void write_array(std::span<const Source> host, const Array<T>& array) {
    const auto mirror = Kokkos::create_mirror_view(array);
    std::transform(host.begin(), host.end(), mirror.data(),
                   [](Source value) { return static_cast<T>(value); });
    Kokkos::deep_copy(array, mirror);
}

template <typename T, typename Source>
Array<T> array_of(std::span<const Source> host) {
    const Array<T> array = make_array<T>(host.size());
    write_array(host, array);
    return array;
}

template <typename T>
Array<T> array_of(const std::vector<T>& host) {
    return array_of<T, T>(std::span<const T>(host));
}

template <typename T>
void read_array(const Array<T>& array, std::span<double> host) {
    const auto mirror = Kokkos::create_mirror_view(array);
    Kokkos::deep_copy(mirror, array);
    std::copy(mirror.data(), mirror.data() + host.size(), host.begin());
}

/// [rows, columns], column index fastest.
template <typename Real>
class KokkosVector final : public DeviceVector {
    KokkosLease lease_;  // before the memory: it goes last

public:
    KokkosVector(Index rows, Index columns)
        : DeviceVector(rows, columns),
          values(make_array<Real>(static_cast<std::size_t>(rows) * columns)) {}

    Array<Real> values;
};

class KokkosSums final : public DeviceSums {
    KokkosLease lease_;

public:
    explicit KokkosSums(Index columns) : DeviceSums(columns), values(make_array<double>(columns)) {}

    Array<double> values;  ///< [columns]
};

/// A matrix of blocks in compressed rows, or the stiffness of the back end's model, which has
/// blocks only while it is assembled.
template <typename Real>
class KokkosOperator final : public DeviceOperator {
    KokkosLease lease_;

public:
    using DeviceOperator::DeviceOperator;

    Array<Index> offsets;          ///< [rows / block_rows() + 1]
    Array<Index> items;            ///< block columns
    Array<Real> blocks;            ///< [items, block_rows(), block_columns()]
    Array<Real> inverse_diagonal;  ///< [rows / block_rows(), block_rows(), block_rows()] or empty
};

}  // namespace palpate
