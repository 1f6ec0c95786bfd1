// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/version.hpp"

#include "solver/linear/factor_libraries.hpp"

namespace palpate {

std::string version_text() { return PALPATE_VERSION; }

std::string build_text() {
    std::string factorisations;
    bool is_gpl = false;
    for (const std::string& name : sparse_factor_names()) {
        factorisations +=
            (factorisations.empty() ? "" : "; also ") + make_sparse_factor(name)->library();
        is_gpl = is_gpl || name == "cholmod";
    }
    return "factorisation: " + factorisations +
           "\nlicence: " + (is_gpl ? "GPL, for CHOLMOD's supernodal module" : "Apache-2.0");
}

}  // namespace palpate
