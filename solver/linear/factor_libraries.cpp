// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/factor_libraries.hpp"

#include <algorithm>

#include "solver/base/error.hpp"
#include "solver/linear/cholmod_factor.hpp"
#include "solver/linear/eigen_factor.hpp"
#include "solver/linear/mumps_factor.hpp"

namespace palpate {

const std::vector<std::string>& sparse_factor_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> found;
        if (has_mumps()) found.push_back("mumps");
        if (has_cholmod()) found.push_back("cholmod");
        found.push_back("eigen");
        return found;
    }();
    return names;
}

std::unique_ptr<SparseFactor> make_sparse_factor(const std::string& name) {
    const auto& names = sparse_factor_names();
    const std::string wanted = name.empty() ? names.front() : name;
    if (std::find(names.begin(), names.end(), wanted) == names.end()) {
        std::string known;
        for (const std::string& there : names) known += (known.empty() ? "" : ", ") + there;
        throw Error(ErrorCode::unsupported, "The direct library \"" + wanted +
                                                "\" is not in this build; it has: " + known + ".");
    }
    if (wanted == "mumps") return make_mumps_factor();
    return wanted == "cholmod" ? make_cholmod_factor() : make_eigen_factor();
}

}  // namespace palpate
