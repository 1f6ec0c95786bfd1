// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/kokkos/session.hpp"

#include <atomic>
#include <cstdlib>
#include <mutex>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::atomic<int> leases = 0;

void end_kokkos() {
    if (leases == 0 && Kokkos::is_initialized()) Kokkos::finalize();
}

void start_kokkos() {
    if (Kokkos::is_initialized()) return;
#if KOKKOS_VERSION >= 30700
    Kokkos::initialize(Kokkos::InitializationSettings().set_disable_warnings(true));
#else
    Kokkos::InitArguments arguments;
    arguments.disable_warnings = true;
    Kokkos::initialize(arguments);
#endif
    std::atexit(end_kokkos);
}

}  // namespace

KokkosLease::KokkosLease() {
    static std::once_flag started;
    try {
        std::call_once(started, start_kokkos);
    } catch (const std::exception& error) {
        throw Error(ErrorCode::device_unavailable, std::string("Kokkos (") + KokkosSpace::name() +
                                                       ") does not start: " + error.what());
    }
    ++leases;
}

KokkosLease::~KokkosLease() { --leases; }

std::string kokkos_version() {
    return "Kokkos " + std::to_string(KOKKOS_VERSION / 10000) + "." +
           std::to_string(KOKKOS_VERSION / 100 % 100) + "." + std::to_string(KOKKOS_VERSION % 100);
}

DeviceInfo kokkos_device() {
    return {.backend = "kokkos",
            .id = KokkosSpace::name(),
            .platform = "Kokkos",
            .name = std::string("Kokkos ") + KokkosSpace::name(),
            .type = runs_on_host ? "host" : "GPU",
            .version = kokkos_version(),
            .driver = "",
            .compute_units = KokkosSpace().concurrency(),
            .memory_gib = 0,
            .has_double = true};
}

ProductChoices& kokkos_product_choices() {
    static ProductChoices choices;
    return choices;
}

}  // namespace palpate
