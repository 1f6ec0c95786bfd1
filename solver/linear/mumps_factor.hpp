// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/linear/sparse_factor.hpp"

namespace palpate {

/// MUMPS' multifrontal L D L^T of a positive definite matrix (Amestoy, Duff, Koster, L'Excellent,
/// SIAM J. Matrix Anal. Appl. 23, 2001), ordered by SCOTCH, on BLAS, which brings the threads.
/// MUMPS keeps state for the whole process, so its calls come one after the other, also those of
/// other factors. CeCILL-C, which may be linked from programs of any licence.
std::unique_ptr<SparseFactor> make_mumps_factor();
/// Whether this build has it; if not, `make_mumps_factor` throws Error(unsupported).
bool has_mumps();

}  // namespace palpate
