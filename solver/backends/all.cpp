// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backend/registry.hpp"
#include "solver/backends/reference/reference_backend.hpp"
#ifdef PALPATE_WITH_KOKKOS
#include "solver/backends/kokkos/kokkos_backend.hpp"
#endif
#ifdef PALPATE_WITH_OPENCL
#include "solver/backends/opencl/opencl_backend.hpp"
#include "solver/backends/opencl/opencl_devices.hpp"
#endif

namespace palpate {

const std::vector<BackendEntry>& backend_registry() {
    static const std::vector<BackendEntry> registry = {
#ifdef PALPATE_WITH_OPENCL
        {"opencl", make_opencl_backend, opencl_devices},
#endif
#ifdef PALPATE_WITH_KOKKOS
        {"kokkos", make_kokkos_backend, kokkos_devices},
#endif
        {"reference", make_reference_backend, reference_devices},
    };
    return registry;
}

}  // namespace palpate
