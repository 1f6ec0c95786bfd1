// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Vectors [num_rows, num_columns], column index fastest.

// At most this many columns share one launch of `axpby`; the host has the same number.
#define MAX_COEFFICIENTS 16

typedef struct {
    real value[MAX_COEFFICIENTS];
} coefficients;

// y[i] = value for i < count. One work item: one number.
PALPATE_KERNEL void fill(global real* y, real value, ulong count) {
    const size_t i = get_global_id(1);
    if (i < count) y[i] = value;
}

// y_c = alpha_c x_c + beta_c y_c for the columns first_column ... of this launch, whose
// coefficients start at entry 0. Where beta_c is 0 the old y does not matter (it may be NaN). x and
// y may be the same. One work item: one row, COLUMN_WIDTH columns.
PALPATE_KERNEL void axpby(coefficients alpha, global const real* x, coefficients beta,
                          global real* y, int num_rows, int num_columns, int first_column) {
    const size_t row = get_global_id(1);
    const size_t column = column_of_item(first_column);
    if (row >= (size_t)num_rows || column >= (size_t)num_columns) return;

    const size_t c = column_of_item(0);
    const size_t at = row * num_columns + column;
    const columns a = LOAD_COLUMNS(alpha.value + c);
    const columns b = LOAD_COLUMNS(beta.value + c);
    const columns scaled_x = a * LOAD_COLUMNS(x + at);
    const columns scaled_y = b * LOAD_COLUMNS(y + at);
    STORE_COLUMNS(b == (columns)(0) ? scaled_x : scaled_x + scaled_y, y + at);
}

// Partial sums of x_c y_c: the host adds the [num_parts, num_columns] results in ascending order.
// One work item: one part of the rows, COLUMN_WIDTH columns; parts are contiguous rows on a CPU and
// every num_parts-th row elsewhere.
PALPATE_KERNEL void dot_parts(global const real* x, global const real* y, global wide* parts,
                              int num_rows, int num_columns, int first_column, int num_parts) {
    const size_t part = get_global_id(1);
    const size_t column = column_of_item(first_column);
    if (part >= (size_t)num_parts || column >= (size_t)num_columns) return;

#if DEVICE_IS_CPU
    const size_t begin = part * num_rows / num_parts;
    const size_t end = (part + 1) * num_rows / num_parts;
    const size_t step = 1;
#else
    const size_t begin = part;
    const size_t end = num_rows;
    const size_t step = num_parts;
#endif
    wide_columns sum = (wide_columns)(0);
    for (size_t row = begin; row < end; row += step) {
        const size_t at = row * num_columns + column;
        sum += WIDEN_COLUMNS(LOAD_COLUMNS(x + at)) * WIDEN_COLUMNS(LOAD_COLUMNS(y + at));
    }
    STORE_WIDE_COLUMNS(sum, parts + part * num_columns + column);
}
