// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/linear/sparse_factor.hpp"

namespace palpate {

/// CHOLMOD's supernodal L L^T (Chen, Davis, Hager, Rajamanickam, ACM TOMS 35, 2008, algorithm 887),
/// factorised on BLAS, which brings its own threads; solved with our `supernodal_solve.hpp`, which
/// only reads the factor. The supernodal module is under the GPL: PALPATE_WITH_CHOLMOD.
std::unique_ptr<SparseFactor> make_cholmod_factor();
/// Whether this build has it; if not, `make_cholmod_factor` throws Error(unsupported).
bool has_cholmod();

}  // namespace palpate
