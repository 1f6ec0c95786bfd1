// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/types.hpp"

namespace palpate {

/// The factor L of A = L L^T as dense blocks of neighbouring columns with one pattern
/// ("supernodes"), in somebody else's memory. Block s has the columns from first_column[s], the
/// rows from row[first_row[s]], its own columns first, and the values from value[first_value[s]],
/// row index fastest; what stands above its diagonal is not read.
struct SupernodalFactor {
    Index num_blocks = 0;
    const int* first_column = nullptr;  ///< [num_blocks + 1]
    const int* first_row = nullptr;     ///< [num_blocks + 1]
    const int* first_value = nullptr;   ///< [num_blocks + 1]
    const int* row = nullptr;
    const double* value = nullptr;
};

/// x := L^-T L^-1 x for x [n, width], column index fastest. One thread, on BLAS. A supernode that
/// meets only zeros on the way down is skipped.
void solve_supernodal(const SupernodalFactor& factor, Index width, double* x);

}  // namespace palpate
