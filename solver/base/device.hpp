// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// In front of a small function that device kernels call too. Host compilers see `inline`; the
/// compilers of CUDA and HIP make it for both sides. Such a function allocates nothing, throws
/// nothing and takes its mathematics from <math.h>, whose overloads exist on both sides.
#if defined(__CUDACC__) || defined(__HIPCC__)
#define PALPATE_DEVICE __host__ __device__ inline
#else
#define PALPATE_DEVICE inline
#endif
