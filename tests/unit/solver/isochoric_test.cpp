// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/materials/isochoric.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/fixtures/materials.hpp"

namespace palpate {
namespace {

constexpr int num_states = 20;
constexpr double step = 1e-5;
constexpr double factor = 1.7;
constexpr double difference_tolerance = 1e-8;  ///< central differences in fp64

Tensor3<double> random_gradient(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-0.2, 0.2);
    Tensor3<double> h;
    for (double& entry : h.m) entry = uniform(random);
    return h;
}

template <class Law>
constexpr bool is_linear = std::is_same_v<Law, LinearLaw<double>>;

/// J^(-1/3) F - I, for Hooke's law the deviator of H.
template <class Law>
Tensor3<double> without_volume_change(const Tensor3<double>& h) {
    Tensor3<double> f = h;
    if constexpr (is_linear<Law>) {
        add_diagonal(f, -trace(h) / 3);
        return f;
    } else {
        add_diagonal(f, 1.0);
        f = scaled(f, std::pow(1 + determinant_change(h), -1.0 / 3));
        add_diagonal(f, -1.0);
        return f;
    }
}

/// Calls work(law, h) with every law at some random states.
template <class Work>
void for_each_law(Work&& work) {
    std::mt19937 random(5);
    for (const MaterialDescription& description : material_laws()) {
        SCOPED_TRACE(description.name);
        for (int i = 0; i < num_states; ++i) {
            const std::vector<double> values = fixtures::random_parameters(description, random);
            const Tensor3<double> h = random_gradient(random);
            with_material_law<double>(description.name, values,
                                      [&](const auto& law) { work(law, h, values); });
        }
    }
}

TEST(IsochoricPart, HasTheEnergyOfTheLawWithoutChangeOfVolume) {
    for_each_law([](const auto& law, const Tensor3<double>& h, const auto&) {
        using Law = std::decay_t<decltype(law)>;
        const auto part = isochoric_part(law);
        const double expected = law.energy(law.state(without_volume_change<Law>(h)));

        EXPECT_NEAR(part.energy(part.state(h)), expected, 1e-12 * expected);
    });
}

TEST(IsochoricPart, StressIsTheSlopeOfItsEnergyAndDoesNoWorkOnTheVolume) {
    for_each_law([](const auto& law, const Tensor3<double>& h, const auto&) {
        using Law = std::decay_t<decltype(law)>;
        const auto part = isochoric_part(law);
        const Tensor3<double> stress = part.stress(part.state(h));
        double size = 0;
        for (const double entry : stress.m) size += std::abs(entry);
        for (int i = 0; i < 9; ++i) {
            Tensor3<double> up = h, down = h;
            up.m[i] += step;
            down.m[i] -= step;
            const double slope =
                (part.energy(part.state(up)) - part.energy(part.state(down))) / (2 * step);
            EXPECT_NEAR(stress.m[i], slope, difference_tolerance * (1 + size));
        }
        Tensor3<double> along = h;
        if constexpr (is_linear<Law>) along = {};
        add_diagonal(along, 1.0);
        EXPECT_NEAR(double_dot(stress, along), 0, 1e-12 * size);
    });
}

TEST(IsochoricPart, ScaledItAddsToTheLaw) {
    for_each_law([](const auto& law, const Tensor3<double>& h, const std::vector<double>& values) {
        const auto part = isochoric_part(law);
        const auto sum = isochorically_scaled(law, factor);
        const auto s = sum.state(h);
        const auto expect_sum = [](const Tensor3<double>& found, const Tensor3<double>& whole,
                                   const Tensor3<double>& more) {
            for (int i = 0; i < 9; ++i)
                EXPECT_NEAR(found.m[i], whole.m[i] + (factor - 1) * more.m[i],
                            1e-10 * (1 + std::abs(found.m[i])));
        };

        const double energy = sum.energy(s);
        EXPECT_NEAR(energy, law.energy(law.state(h)) + (factor - 1) * part.energy(part.state(h)),
                    1e-12 * energy);
        expect_sum(sum.stress(s), law.stress(law.state(h)), part.stress(part.state(h)));
        expect_sum(sum.tangent_apply(s, h), law.tangent_apply(law.state(h), h),
                   part.tangent_apply(part_state(part, s), h));
        for (std::size_t k = 0; k < values.size(); ++k) {
            const int p = static_cast<int>(k);
            expect_sum(sum.parameter_stress(s, p), law.parameter_stress(law.state(h), p),
                       part.parameter_stress(part.state(h), p));
        }
    });
}

TEST(IsochoricPart, DerivativesByParametersMatchDifferences) {
    for_each_law([](const auto& law, const Tensor3<double>& h, const std::vector<double>& values) {
        using Law = std::decay_t<decltype(law)>;
        const auto part = isochoric_part(law);
        for (std::size_t k = 0; k < values.size(); ++k) {
            const auto stress_at = [&](double change) {
                std::vector<double> moved = values;
                moved[k] += change * values[k];
                const auto other = isochoric_part(Law::from_parameters(moved.data()));
                return other.stress(other.state(h));
            };
            const Tensor3<double> found = part.parameter_stress(part.state(h), static_cast<int>(k));
            const Tensor3<double> up = stress_at(step), down = stress_at(-step);
            for (int i = 0; i < 9; ++i) {
                const double slope = (up.m[i] - down.m[i]) / (2 * step * values[k]);
                EXPECT_NEAR(found.m[i], slope, 1e-7 * (1 + std::abs(up.m[i] / values[k])));
            }
        }
    });
}

}  // namespace
}  // namespace palpate
