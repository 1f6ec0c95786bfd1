// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// The vector half of block conjugate gradients, column by column (Saad, Iterative Methods for
// Sparse Linear Systems, 2003, algorithm 9.1). Rows are cut into parts (parts.cl). Inner products
// come and go as partial sums, so that no number travels to the host.
//   x, y, z, p, q, r  [num_rows, num_columns]
//   rz, pq, ...       [their number of parts, num_columns]
#if LANES
#define ROW_STRIDE COLUMN_WIDTH
#else
#define ROW_STRIDE num_columns
#endif

// parts of x . y
PALPATE_KERNEL void dot_columns(global const real* x, global const real* y, global wide* parts,
                                int num_rows, int num_columns, int first_column) {
    const size_t column = column_of_item(first_column);
    const size_t end = column < (size_t)num_columns ? END_ROW(num_rows) : 0;
    wide_columns sum = (wide_columns)(0);
    for (size_t row = FIRST_ROW(num_rows); row < end; row += ROW_STEP) {
        const size_t at = row * ROW_STRIDE + column;
        sum += WIDEN_COLUMNS(LOAD_COLUMNS(x + at)) * WIDEN_COLUMNS(LOAD_COLUMNS(y + at));
    }
    SUM_SCRATCH
    STORE_PART(sum, parts, num_columns, column);
}

// Columns with rr > limit and pq > 0: x += (rz / pq) p, r -= (rz / pq) q. All columns: parts of the
// new r . r. `rr_new` is another buffer than `rr`, which other work groups may still be reading.
PALPATE_KERNEL void advance(global const wide* rz, int rz_parts, global const wide* pq,
                            int pq_parts, global const wide* rr, int rr_parts,
                            global const wide* limit, int limit_parts, global const real* p,
                            global const real* q, global real* x, global real* r,
                            global wide* rr_new, int num_rows, int num_columns, int first_column) {
    const size_t column = column_of_item(first_column);
    const size_t end = column < (size_t)num_columns ? END_ROW(num_rows) : 0;
    wide_columns sum = (wide_columns)(0);
    if (column < (size_t)num_columns) {
        const column_numbers curvature = sum_of_parts(pq, pq_parts, num_columns, column);
        const column_numbers length = sum_of_parts(rz, rz_parts, num_columns, column) / curvature;
        const column_numbers left = sum_of_parts(rr, rr_parts, num_columns, column);
        const column_numbers enough = sum_of_parts(limit, limit_parts, num_columns, column);
        const column_numbers none = (column_numbers)(0);
        const columns step =
            NARROW_NUMBERS(curvature > none ? (left > enough ? length : none) : none);
        for (size_t row = FIRST_ROW(num_rows); row < end; row += ROW_STEP) {
            const size_t at = row * ROW_STRIDE + column;
            STORE_COLUMNS(LOAD_COLUMNS(x + at) + step * LOAD_COLUMNS(p + at), x + at);
            const columns rest = LOAD_COLUMNS(r + at) - step * LOAD_COLUMNS(q + at);
            STORE_COLUMNS(rest, r + at);
            sum += WIDEN_COLUMNS(rest) * WIDEN_COLUMNS(rest);
        }
    }
    SUM_SCRATCH
    STORE_PART(sum, rr_new, num_columns, column);
}

// p = z + (rz_new / rz) p; p = z where rz is not positive.
PALPATE_KERNEL void turn(global const wide* rz_new, int rz_new_parts, global const wide* rz,
                         int rz_parts, global const real* z, global real* p, int num_rows,
                         int num_columns, int first_column) {
    const size_t column = column_of_item(first_column);
    if (column >= (size_t)num_columns) return;
    const column_numbers before = sum_of_parts(rz, rz_parts, num_columns, column);
    const column_numbers ratio = sum_of_parts(rz_new, rz_new_parts, num_columns, column) / before;
    const column_numbers none = (column_numbers)(0);
    const columns beta = NARROW_NUMBERS(before > none ? ratio : none);
    for (size_t row = FIRST_ROW(num_rows); row < END_ROW(num_rows); row += ROW_STEP) {
        const size_t at = row * ROW_STRIDE + column;
        const columns here = LOAD_COLUMNS(z + at);
        const columns turned = here + beta * LOAD_COLUMNS(p + at);
        STORE_COLUMNS(beta == (columns)(0) ? here : turned, p + at);  // p may not hold numbers yet
    }
}
