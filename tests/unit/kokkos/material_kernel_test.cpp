// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Kokkos_Core.hpp>

#include "solver/backends/kokkos/kokkos_backend.hpp"
#include "tests/fixtures/materials.hpp"

namespace palpate {
namespace {

using namespace fixtures;

constexpr double rounding_tolerance = 1e-12;
constexpr int num_points = 100;

/// Energy and stress of point p, as an element loop would have them.
template <class Law>
struct EvaluatePoints {
    Law law;
    Kokkos::View<Tensor3<double>*> gradients;
    Kokkos::View<double*> energy;
    Kokkos::View<Tensor3<double>*> stress;

    KOKKOS_INLINE_FUNCTION void operator()(const int p) const {
        const auto state = law.state(gradients(p));
        energy(p) = law.energy(state);
        stress(p) = law.stress(state);
    }
};

template <class Law>
void expect_same_on_device(const Law& law, std::mt19937& random) {
    EvaluatePoints<Law> evaluate{law, Kokkos::View<Tensor3<double>*>("gradients", num_points),
                                 Kokkos::View<double*>("energy", num_points),
                                 Kokkos::View<Tensor3<double>*>("stress", num_points)};
    const auto gradients = Kokkos::create_mirror_view(evaluate.gradients);
    for (int p = 0; p < num_points; ++p) gradients(p) = moderate_gradient(random);
    Kokkos::deep_copy(evaluate.gradients, gradients);

    Kokkos::parallel_for("EvaluatePoints", num_points, evaluate);

    const auto energy = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), evaluate.energy);
    const auto stress = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), evaluate.stress);
    for (int p = 0; p < num_points; ++p) {
        const auto state = law.state(gradients(p));
        EXPECT_NEAR(energy(p) / law.energy(state), 1, rounding_tolerance);
        const Mat3 expected = matrix_of(law.stress(state));
        EXPECT_LE((matrix_of(stress(p)) - expected).norm(), rounding_tolerance * expected.norm());
    }
}

TEST(MaterialKernel, EvaluatesEveryLawInsideAKokkosKernel) {
    // Starts Kokkos.
    const auto backend = make_kokkos_backend({Precision::double_, {}, ""});
    std::mt19937 random(2);

    for (const MaterialDescription& description : material_laws())
        with_material_law<double>(description.name, random_parameters(description, random),
                                  [&](const auto& law) { expect_same_on_device(law, random); });
}

}  // namespace
}  // namespace palpate
