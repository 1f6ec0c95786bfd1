// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backends/kokkos/session.hpp"
#include "solver/base/multiversion.hpp"

namespace palpate {

/// A vector register of the host, or one number; and the same in an array of numbers.
template <typename Real, int lanes>
struct LaneRegister {
    typedef Real Type __attribute__((vector_size(lanes * sizeof(Real))));
    typedef Real InArray
        __attribute__((vector_size(lanes * sizeof(Real)), aligned(sizeof(Real)), may_alias));
};
template <typename Real>
struct LaneRegister<Real, 1> {
    using Type = Real;
    using InArray = Real;
};

/// `width` neighbouring columns of one row: one number on a GPU, vector registers on a host.
/// Said to the compiler outright, because it turns loops over small arrays into vector instructions
/// only sometimes, and keeps wider vectors than it has registers for in memory.
template <typename Real, int width>
class Lanes {
public:
    static constexpr int register_bytes = PALPATE_REGISTER_BYTES;
    static constexpr int lanes_of_register = width * sizeof(Real) <= register_bytes
                                                 ? width
                                                 : register_bytes / static_cast<int>(sizeof(Real));
    static constexpr int num_registers = width / lanes_of_register;
    using Register = typename LaneRegister<Real, lanes_of_register>::Type;
    using InArray = typename LaneRegister<Real, lanes_of_register>::InArray;

    KOKKOS_INLINE_FUNCTION void load(const Real* from) {
        for (int k = 0; k < num_registers; ++k)
            value_[k] = *reinterpret_cast<const InArray*>(from + k * lanes_of_register);
    }
    KOKKOS_INLINE_FUNCTION void store(Real* to) const {
        for (int k = 0; k < num_registers; ++k)
            *reinterpret_cast<InArray*>(to + k * lanes_of_register) = value_[k];
    }
    KOKKOS_INLINE_FUNCTION void clear() {
        for (int k = 0; k < num_registers; ++k) value_[k] = Register{};
    }

    KOKKOS_INLINE_FUNCTION void add(const Lanes& other) {
        for (int k = 0; k < num_registers; ++k) value_[k] += other.value_[k];
    }
    KOKKOS_INLINE_FUNCTION void subtract_from(const Lanes& other) {
        for (int k = 0; k < num_registers; ++k) value_[k] = other.value_[k] - value_[k];
    }
    KOKKOS_INLINE_FUNCTION void scale(Real factor) {
        for (int k = 0; k < num_registers; ++k) value_[k] *= factor;
    }
    KOKKOS_INLINE_FUNCTION void add_product(Real factor, const Lanes& other) {
        for (int k = 0; k < num_registers; ++k) value_[k] += factor * other.value_[k];
    }
    KOKKOS_INLINE_FUNCTION void add_product(const Lanes& a, const Lanes& b) {
        for (int k = 0; k < num_registers; ++k) value_[k] += a.value_[k] * b.value_[k];
    }
    KOKKOS_INLINE_FUNCTION void subtract_product(const Lanes& a, const Lanes& b) {
        for (int k = 0; k < num_registers; ++k) value_[k] -= a.value_[k] * b.value_[k];
    }
    /// In fp64, whatever the factors are.
    template <typename Factor>
    KOKKOS_INLINE_FUNCTION void add_wide_product(const Lanes<Factor, width>& a,
                                                 const Lanes<Factor, width>& b) {
        if constexpr (std::is_same_v<Factor, Real>) {
            add_product(a, b);
        } else {
            Lanes wide_a, wide_b;
            wide_a.widen(a);
            wide_b.widen(b);
            add_product(wide_a, wide_b);
        }
    }

private:
    template <typename, int>
    friend class Lanes;

    template <typename Factor>
    KOKKOS_INLINE_FUNCTION void widen(const Lanes<Factor, width>& narrow) {
        if constexpr (width == 1) {
            value_[0] = static_cast<Real>(narrow.value_[0]);
        } else {
            Factor numbers[width];
            narrow.store(numbers);
            using Part = typename LaneRegister<Factor, lanes_of_register>::InArray;
            for (int k = 0; k < num_registers; ++k)
                value_[k] = __builtin_convertvector(
                    *reinterpret_cast<const Part*>(numbers + k * lanes_of_register), Register);
        }
    }

    Register value_[num_registers];
};

}  // namespace palpate
