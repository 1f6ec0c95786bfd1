// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// First part of every program: the number types and the index helpers.
//
// Defines without a default (physics and layout):
//   REAL_IS_DOUBLE   1: vectors are double, 0: float
//   HAS_DOUBLE       1: the device has cl_khr_fp64, so long sums are carried in double
//   DEVICE_IS_CPU    1: one work item takes contiguous data and vector types; 0: neighbouring work
//                    items take neighbouring data
//   COLUMN_WIDTH     columns that one work item handles (1, 2, 4, 8 or 16)
// Tuning: WORK_GROUP_ROWS x WORK_GROUP_COLUMNS, the size of a work group.
//
// Vectors are [rows, columns] with the column index fastest. Every kernel runs over
// (column groups, rows): dimension 0 counts groups of COLUMN_WIDTH columns, dimension 1 rows, nodes
// or elements.
#if !defined(REAL_IS_DOUBLE) || !defined(HAS_DOUBLE)
#error "REAL_IS_DOUBLE and HAS_DOUBLE must be defined"
#endif
#if !defined(DEVICE_IS_CPU) || !defined(COLUMN_WIDTH)
#error "DEVICE_IS_CPU and COLUMN_WIDTH must be defined"
#endif
#if REAL_IS_DOUBLE && !HAS_DOUBLE
#error "double precision needs a device with cl_khr_fp64"
#endif
#ifndef WORK_GROUP_ROWS
#define WORK_GROUP_ROWS 64
#endif
#ifndef WORK_GROUP_COLUMNS
#define WORK_GROUP_COLUMNS 1
#endif

#if HAS_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define WIDE_NAME double
typedef double wide;
#else
#define WIDE_NAME float
typedef float wide;
#endif

#if REAL_IS_DOUBLE
#define REAL_NAME double
typedef double real;
typedef double4 real4;
typedef double8 real8;
#else
#define REAL_NAME float
typedef float real;
typedef float4 real4;
typedef float8 real8;
#endif

#define JOIN_NOW(a, b) a##b
#define JOIN(a, b) JOIN_NOW(a, b)

// `columns`: COLUMN_WIDTH reals of one row, `wide_columns`: the same for long sums.
#if COLUMN_WIDTH == 1
typedef real columns;
typedef wide wide_columns;
#define LOAD_COLUMNS(pointer) (*(pointer))
#define STORE_COLUMNS(value, pointer) (*(pointer) = (value))
#define WIDEN_COLUMNS(value) ((wide)(value))
#define NARROW_COLUMNS(value) ((real)(value))
#define LOAD_WIDE_COLUMNS(pointer) (*(pointer))
#define STORE_WIDE_COLUMNS(value, pointer) (*(pointer) = (value))
#else
typedef JOIN(REAL_NAME, COLUMN_WIDTH) columns;
typedef JOIN(WIDE_NAME, COLUMN_WIDTH) wide_columns;
#define LOAD_COLUMNS(pointer) JOIN(vload, COLUMN_WIDTH)(0, pointer)
#define STORE_COLUMNS(value, pointer) JOIN(vstore, COLUMN_WIDTH)(value, 0, pointer)
#define WIDEN_COLUMNS(value) JOIN(convert_, JOIN(WIDE_NAME, COLUMN_WIDTH))(value)
#define NARROW_COLUMNS(value) JOIN(convert_, JOIN(REAL_NAME, COLUMN_WIDTH))(value)
#define LOAD_WIDE_COLUMNS(pointer) JOIN(vload, COLUMN_WIDTH)(0, pointer)
#define STORE_WIDE_COLUMNS(value, pointer) JOIN(vstore, COLUMN_WIDTH)(value, 0, pointer)
#endif

#define PALPATE_KERNEL \
    kernel __attribute__((reqd_work_group_size(WORK_GROUP_COLUMNS, WORK_GROUP_ROWS, 1)))

// First column of this work item in a launch that starts at `first_column`.
static inline size_t column_of_item(int first_column) {
    return (size_t)first_column + get_global_id(0) * COLUMN_WIDTH;
}
