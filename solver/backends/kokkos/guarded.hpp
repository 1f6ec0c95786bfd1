// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <new>
#include <string>

#include "solver/base/error.hpp"

namespace palpate::kokkos {

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

}  // namespace palpate::kokkos
