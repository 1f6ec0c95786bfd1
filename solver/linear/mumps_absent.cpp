// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Takes the place of mumps_factor.cpp in builds without MUMPS.
#include "solver/base/error.hpp"
#include "solver/linear/mumps_factor.hpp"

namespace palpate {

bool has_mumps() { return false; }

std::unique_ptr<SparseFactor> make_mumps_factor() {
    throw Error(ErrorCode::unsupported,
                "This build has no MUMPS; install libmumps-seq-dev and build with "
                "PALPATE_WITH_MUMPS=ON.");
}

}  // namespace palpate
