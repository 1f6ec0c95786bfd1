// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Kokkos_Core.hpp>
#include <string>

#include "solver/backend/product_choice.hpp"
#include "solver/backend/registry.hpp"

namespace palpate {

/// Where everything of this back end runs and lives: what Kokkos was built for.
using KokkosSpace = Kokkos::DefaultExecutionSpace;

/// True for Serial, OpenMP and C++ threads: loops over columns are then vectorised instead of
/// being spread over neighbouring threads.
inline constexpr bool runs_on_host = std::is_same_v<KokkosSpace, Kokkos::DefaultHostExecutionSpace>;

/// Whoever holds memory of Kokkos holds one of these. The first starts Kokkos unless the host
/// program did; what this library started ends with the process, if all memory is back by then.
/// Throws Error(device_unavailable) where Kokkos does not start.
class KokkosLease {
public:
    KokkosLease();
    ~KokkosLease();
    KokkosLease(const KokkosLease&) = delete;
    KokkosLease& operator=(const KokkosLease&) = delete;
};

std::string kokkos_version();
/// The one device of this Kokkos. Needs a lease.
DeviceInfo kokkos_device();

/// What automatic products chose, for the life of the process.
ProductChoices& kokkos_product_choices();

}  // namespace palpate
