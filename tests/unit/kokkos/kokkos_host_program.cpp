// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <Kokkos_Core.hpp>

#include "solver/backends/kokkos/kokkos_backend.hpp"

/// A program that starts and ends Kokkos itself: the back end must do neither. Returns 0 if so.
int main(int argc, char** argv) {
    Kokkos::initialize(argc, argv);
    double sum = 0;
    {
        const auto backend = palpate::make_kokkos_backend({palpate::Precision::double_, {}, ""});
        const auto x = backend->make_vector(1000, 1);
        const auto xx = backend->make_sums(1);
        backend->fill(*x, 2.0);
        backend->dot(*x, *x, *xx);
        backend->read(*xx, {&sum, 1});
    }
    if (!Kokkos::is_initialized()) return 1;
    Kokkos::finalize();
    return sum == 4000 ? 0 : 2;
}
