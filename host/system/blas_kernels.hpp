// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// OpenBLAS that is older than the processor computes with kernels for the oldest one, several
/// times slower. Then: starts the program again, with OPENBLAS_CORETYPE naming kernels that the
/// processor can run. Nothing where the variable is set, or with another BLAS. To be called from
/// main, before anything else; `arguments` are main's.
void take_fast_blas_kernels(char** arguments);

}  // namespace palpate
