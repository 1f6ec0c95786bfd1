// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Takes the place of dissected_order.cpp in builds without MUMPS.
#include "solver/base/error.hpp"
#include "solver/linear/dissected_order.hpp"

namespace palpate {

bool has_dissection() { return false; }

std::vector<int> dissected_order(const Eigen::SparseMatrix<double>&) {
    throw Error(ErrorCode::unsupported,
                "This build has no SCOTCH; install libscotch-dev and build with "
                "PALPATE_WITH_MUMPS=ON.");
}

}  // namespace palpate
