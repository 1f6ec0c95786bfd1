// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Vectors [num_rows, num_columns], column index fastest.
// Define: FROM_IS_DOUBLE, the numbers that `copy_columns` reads.
#ifndef FROM_IS_DOUBLE
#define FROM_IS_DOUBLE REAL_IS_DOUBLE
#endif
#if FROM_IS_DOUBLE
typedef double from_real;
#else
typedef float from_real;
#endif

// y[i] = value for first <= i < end. One work item: one number.
PALPATE_KERNEL void fill(global real* y, real value, ulong first, ulong end) {
    const size_t i = first + get_global_id(1);
    if (i < end) y[i] = value;
}

// to[row, to_column[i]] = from[row, from_column[i]] for i < count. One work item: one row.
PALPATE_KERNEL void copy_columns(global const from_real* from, global const int* from_column,
                                 int num_from_columns, global real* to, global const int* to_column,
                                 int num_to_columns, int num_rows, int count) {
    const size_t row = get_global_id(1);
    if (row >= (size_t)num_rows) return;
    for (int i = 0; i < count; ++i)
        to[row * num_to_columns + to_column[i]] =
            (real)from[row * num_from_columns + from_column[i]];
}

// to = from, `count` numbers. One work item: one number.
PALPATE_KERNEL void copy_all(global const from_real* from, global real* to, ulong count) {
    const size_t i = get_global_id(1);
    if (i < count) to[i] = (real)from[i];
}
