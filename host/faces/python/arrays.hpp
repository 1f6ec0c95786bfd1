// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>

// NumPy arrays as palpate takes and gives them, none of them copied.
namespace palpate_python {

namespace nb = nanobind;

using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const std::int32_t, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const std::uint8_t, nb::c_contig, nb::device::cpu>;
using Voxels = nb::ndarray<const std::uint16_t, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
/// Numbers that Python owns.
using Array = nb::ndarray<nb::numpy, double>;

/// A new array of zeros.
inline Array new_array(std::initializer_list<std::size_t> shape) {
    std::size_t count = 1;
    for (const std::size_t n : shape) count *= n;
    auto* values = new double[count]();
    nb::capsule owner(values, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    return Array(values, shape, owner);
}

/// A view of what `owner` holds, which it keeps alive.
template <class Number, class... Size>
auto view(nb::handle owner, const Number* values, Size... shape) {
    return nb::ndarray<nb::numpy, const Number>(values, {static_cast<std::size_t>(shape)...},
                                                owner);
}

}  // namespace palpate_python
