// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Kernels over parts: the rows of a launch are cut into get_num_groups(1) parts, one work group
// each, and a sum over rows leaves one number per part and column. Whoever needs the sum adds the
// parts in ascending order: no launch, no atomics and no round trip to the host in between, and the
// same bits every time.
//
// On a CPU a group is one work item and a part is contiguous rows; elsewhere the items of a group
// take neighbouring rows and columns, and add up in local memory (at most WORK_GROUP_COLUMNS x
// WORK_GROUP_ROWS x 8 bytes).
//
// Define: LANES 1: the vectors have one column on a CPU, and COLUMN_WIDTH neighbouring rows take
// the place of columns. Such vectors are padded with zeros to whole lanes; `num_rows` counts these.
#ifndef LANES
#define LANES 0
#endif

#if DEVICE_IS_CPU
#define FIRST_ROW(num_rows) (get_group_id(1) * (size_t)(num_rows) / get_num_groups(1))
#define END_ROW(num_rows) ((get_group_id(1) + 1) * (size_t)(num_rows) / get_num_groups(1))
#define ROW_STEP 1
#define SUM_SCRATCH
#define STORE_PART(sum, parts, num_columns, column) store_part(sum, parts, num_columns, column)
#else
#define FIRST_ROW(num_rows) (get_group_id(1) * WORK_GROUP_ROWS + get_local_id(1))
#define END_ROW(num_rows) ((size_t)(num_rows))
#define ROW_STEP (get_num_groups(1) * WORK_GROUP_ROWS)
#define SUM_SCRATCH local wide scratch[WORK_GROUP_COLUMNS * WORK_GROUP_ROWS];
#define STORE_PART(sum, parts, num_columns, column) \
    store_part(sum, parts, num_columns, column, scratch)
#endif

// `column_numbers`: one number for every column of a work item.
#if LANES
typedef wide column_numbers;
#define LOAD_NUMBERS(pointer) (*(pointer))
#define STORE_NUMBERS(value, pointer) (*(pointer) = (value))
#define NARROW_NUMBERS(value) ((columns)((real)(value)))
static inline wide add_lanes(wide_columns v) {
    const JOIN(WIDE_NAME, 8) half_sum = v.lo + v.hi;
    const JOIN(WIDE_NAME, 4) quarter = half_sum.lo + half_sum.hi;
    const JOIN(WIDE_NAME, 2) eighth = quarter.lo + quarter.hi;
    return eighth.lo + eighth.hi;
}
#else
typedef wide_columns column_numbers;
#define LOAD_NUMBERS(pointer) LOAD_WIDE_COLUMNS(pointer)
#define STORE_NUMBERS(value, pointer) STORE_WIDE_COLUMNS(value, pointer)
#define NARROW_NUMBERS(value) NARROW_COLUMNS(value)
#define add_lanes(v) (v)
#endif

// Sums over all parts, for the columns of this work item: parts [num_parts, num_columns].
static inline column_numbers sum_of_parts(global const wide* parts, int num_parts, int num_columns,
                                          size_t column) {
    column_numbers sum = (column_numbers)(0);
    for (int k = 0; k < num_parts; ++k)
        sum += LOAD_NUMBERS(parts + (size_t)k * num_columns + column);
    return sum;
}

// Writes the sum of this work group; every item of the group must come here.
#if DEVICE_IS_CPU
static inline void store_part(wide_columns sum, global wide* parts, int num_columns,
                              size_t column) {
    STORE_NUMBERS(add_lanes(sum), parts + get_group_id(1) * num_columns + column);
}
#else
static inline void store_part(wide_columns sum, global wide* parts, int num_columns, size_t column,
                              local wide* scratch) {
    const size_t row = get_local_id(1);
    const size_t item = row * WORK_GROUP_COLUMNS + get_local_id(0);
    scratch[item] = sum;
    for (size_t rows = WORK_GROUP_ROWS / 2; rows > 0; rows /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (row < rows) scratch[item] += scratch[item + rows * WORK_GROUP_COLUMNS];
    }
    if (row == 0 && column < (size_t)num_columns)
        parts[get_group_id(1) * num_columns + column] = scratch[item];
}
#endif

// A sum that is wanted only where HAS_SUM.
#if defined(HAS_SUM) && HAS_SUM
#define START_SUM(sum) wide_columns sum = (wide_columns)(0)
#define ADD_SHARE(sum, share) sum += (share)
#else
#define START_SUM(sum)
#define ADD_SHARE(sum, share) (void)(share)
#endif
