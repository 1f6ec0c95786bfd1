// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Takes the place of cholmod_factor.cpp in builds without CHOLMOD.
#include "solver/base/error.hpp"
#include "solver/linear/cholmod_factor.hpp"

namespace palpate {

bool has_cholmod() { return false; }

std::unique_ptr<SparseFactor> make_cholmod_factor() {
    throw Error(ErrorCode::unsupported,
                "This build has no CHOLMOD; build with PALPATE_WITH_CHOLMOD=ON.");
}

}  // namespace palpate
