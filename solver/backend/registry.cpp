// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backend/registry.hpp"

#include "solver/base/error.hpp"

namespace palpate {

std::unique_ptr<Backend> make_backend(const std::string& name, const BackendOptions& options) {
    std::string known;
    for (const BackendEntry& entry : backend_registry()) {
        if (entry.name == name) return entry.make(options);
        known += (known.empty() ? "" : ", ") + entry.name;
    }
    throw Error(
        ErrorCode::unsupported,
        "Back end \"" + name + "\" is not compiled into this build; choose one of: " + known + ".");
}

}  // namespace palpate
