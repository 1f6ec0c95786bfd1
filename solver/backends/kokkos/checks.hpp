// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <new>
#include <string>

#include "solver/backend/device_vector.hpp"
#include "solver/base/error.hpp"

// What every function of this back end asks of its arguments.
namespace palpate::kokkos {

inline void require(bool holds, const char* function, const char* what) {
    if (!holds)
        throw Error(ErrorCode::invalid_argument,
                    std::string("Back end kokkos, ") + function + ": " + what + ".");
}

/// Runs `work` and turns what Kokkos throws into errors of ours.
template <typename Work>
auto guarded(const char* function, const Work& work) {
    try {
        return work();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::out_of_memory,
                    std::string("Back end kokkos ran out of memory in ") + function + ".");
    } catch (const std::exception& error) {
        throw Error(ErrorCode::device_failed, std::string("Back end kokkos failed in ") + function +
                                                  ": " + error.what() + ".");
    }
}

template <typename Own, typename Base>
Own& own(Base& base, const char* function) {
    auto* const found = dynamic_cast<Own*>(&base);
    require(found != nullptr, function,
            "an argument belongs to another back end or another precision");
    return *found;
}

inline void require_same_shape(const DeviceVector& x, const DeviceVector& y, const char* function) {
    require(x.rows() == y.rows() && x.columns() == y.columns(), function,
            "the vectors differ in rows or columns");
}

}  // namespace palpate::kokkos
