// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "solver/materials/registry.hpp"

// The laws against closed forms in principal stretches, written here from the energies in the
// plainest way, with no care for rounding.
namespace palpate {
namespace {

constexpr double closed_form_tolerance = 1e-11;  ///< plain formulas, lateral stretch by bisection

using Stretches = std::array<double, 3>;

double sum_of_squares(const Stretches& s) { return s[0] * s[0] + s[1] * s[1] + s[2] * s[2]; }
double volume(const Stretches& s) { return s[0] * s[1] * s[2]; }

/// A law in stretches: its energy and its first Piola stress along axis i, kPa.
struct ClosedForm {
    std::string law;
    std::vector<double> parameters;
    std::function<double(const Stretches&)> energy;
    std::function<double(const Stretches&, int)> stress;
    /// Cauchy stress of F = I + g e1 e2^T: sigma_11, sigma_22, sigma_12.
    std::function<std::array<double, 3>(double)> simple_shear;
};

void PrintTo(const ClosedForm& form, std::ostream* out) { *out << form.law; }

/// psi(J1 - 3) + kappa/2 (J - 1)^2: P_i = (2 psi' J^(-2/3) (s_i^2 - I1/3) + kappa (J - 1) J) / s_i.
/// Simple shear keeps the volume: J1 - 3 = g^2 and sigma = 2 psi' dev(F F^T).
ClosedForm reduced(std::string law, std::vector<double> parameters, double kappa,
                   std::function<double(double)> psi, std::function<double(double)> slope) {
    const auto x = [](const Stretches& s) {
        return sum_of_squares(s) * std::pow(volume(s), -2.0 / 3.0) - 3;
    };
    return {std::move(law), std::move(parameters),
            [=](const Stretches& s) {
                return psi(x(s)) + kappa / 2 * (volume(s) - 1) * (volume(s) - 1);
            },
            [=](const Stretches& s, int i) {
                const double j = volume(s);
                return (2 * slope(x(s)) * std::pow(j, -2.0 / 3.0) *
                            (s[i] * s[i] - sum_of_squares(s) / 3) +
                        kappa * (j - 1) * j) /
                       s[i];
            },
            [=](double g) {
                const double twice = 2 * slope(g * g);
                return std::array{twice * 2 * g * g / 3, -twice * g * g / 3, twice * g};
            }};
}

ClosedForm linear() {
    const double e = 12, nu = 0.4;
    const double mu = e / (2 * (1 + nu)), lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
    const auto dilatation = [](const Stretches& s) { return s[0] + s[1] + s[2] - 3; };
    return {"linear",
            {e, nu},
            [=](const Stretches& s) {
                double squares = 0;
                for (double stretch : s) squares += (stretch - 1) * (stretch - 1);
                return lambda / 2 * dilatation(s) * dilatation(s) + mu * squares;
            },
            [=](const Stretches& s, int i) { return lambda * dilatation(s) + 2 * mu * (s[i] - 1); },
            nullptr};
}

ClosedForm neo_hookean() {
    const double e = 20, nu = 0.45;
    const double mu = e / (2 * (1 + nu)), lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
    return {"neo-hookean",
            {e, nu},
            [=](const Stretches& s) {
                const double log_j = std::log(volume(s));
                return mu / 2 * (sum_of_squares(s) - 3 - 2 * log_j) + lambda / 2 * log_j * log_j;
            },
            [=](const Stretches& s, int i) {
                return mu * (s[i] - 1 / s[i]) + lambda * std::log(volume(s)) / s[i];
            },
            [=](double g) {
                return std::array{mu * g * g, 0.0, mu * g};
            }};
}

ClosedForm neo_hookean_reduced() {
    return reduced(
        "neo-hookean-reduced", {3, 40}, 40, [](double x) { return 3 * x; },
        [](double) { return 3.0; });
}

ClosedForm veronda_westmann() {
    const double mu = 2, gamma = 3;
    return reduced(
        "veronda-westmann", {mu, gamma, 25}, 25,
        [=](double x) { return mu / gamma * (std::exp(gamma * x) - 1); },
        [=](double x) { return mu * std::exp(gamma * x); });
}

ClosedForm reduced_polynomial() {
    const double c1 = 4, c2 = 7, d1 = 0.05;
    return reduced(
        "reduced-polynomial", {c1, c2, d1}, 2 / d1, [=](double x) { return c1 * x + c2 * x * x; },
        [=](double x) { return c1 + 2 * c2 * x; });
}

ClosedForm yeoh() {
    const double c1 = 4, c2 = 7, c3 = 9;
    return reduced(
        "yeoh", {c1, c2, c3, 40}, 40,
        [=](double x) { return c1 * x + c2 * x * x + c3 * x * x * x; },
        [=](double x) { return c1 + 2 * c2 * x + 3 * c3 * x * x; });
}

std::vector<ClosedForm> closed_forms() {
    return {linear(),           neo_hookean(),        neo_hookean_reduced(),
            veronda_westmann(), reduced_polynomial(), yeoh()};
}

/// The stretch of the free axes for which they carry no stress.
double free_stretch(const ClosedForm& form, const std::function<Stretches(double)>& with,
                    int axis) {
    double low = 0.3, high = 2;
    for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (form.stress(with(middle), axis) < 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

struct PointResult {
    double energy = 0;
    Tensor3<double> stress;
};

PointResult evaluate(const ClosedForm& form, const Tensor3<double>& h) {
    PointResult result;
    with_material_law<double>(form.law, form.parameters, [&](const auto& law) {
        const auto state = law.state(h);
        ASSERT_TRUE(state.is_valid);
        result = {law.energy(state), law.stress(state)};
    });
    return result;
}

/// Expects energy and stress of the closed form, and none on the free axes.
void expect_closed_form(const ClosedForm& form, const Stretches& s, std::vector<int> free_axes) {
    const PointResult result = evaluate(form, {{s[0] - 1, 0, 0, 0, s[1] - 1, 0, 0, 0, s[2] - 1}});

    const double size = std::abs(form.stress(s, 0));
    EXPECT_NEAR(result.energy / form.energy(s), 1, closed_form_tolerance);
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(result.stress.m[4 * i], form.stress(s, i), closed_form_tolerance * size);
    for (int i : free_axes) EXPECT_NEAR(result.stress.m[4 * i], 0, closed_form_tolerance * size);
}

class MaterialStretch : public testing::TestWithParam<ClosedForm> {};

TEST_P(MaterialStretch, UniaxialTensionHasTheClosedFormStress) {
    for (double stretch : {0.6, 0.8, 0.95, 1.05, 1.2, 1.5}) {
        const auto with = [&](double lateral) { return Stretches{stretch, lateral, lateral}; };
        const double lateral = free_stretch(GetParam(), with, 1);

        expect_closed_form(GetParam(), with(lateral), {1, 2});
        EXPECT_EQ(lateral<1, stretch> 1);
    }
}

TEST_P(MaterialStretch, EquibiaxialTensionHasTheClosedFormStress) {
    for (double stretch : {0.8, 0.95, 1.05, 1.25}) {
        const auto with = [&](double thickness) { return Stretches{stretch, stretch, thickness}; };
        const double thickness = free_stretch(GetParam(), with, 2);

        expect_closed_form(GetParam(), with(thickness), {2});
        EXPECT_EQ(thickness<1, stretch> 1);
    }
}

TEST_P(MaterialStretch, SimpleShearHasTheClosedFormStress) {
    if (!GetParam().simple_shear) GTEST_SKIP() << "Hooke's law has no stress of second order.";
    for (double g : {-0.5, 0.01, 0.3, 0.8}) {
        const auto [s11, s22, s12] = GetParam().simple_shear(g);

        const PointResult result = evaluate(GetParam(), {{0, g, 0, 0, 0, 0, 0, 0, 0}});

        // P = sigma F^-T with F^-T = I - g e2 e1^T.
        const double expected[4] = {s11 - g * s12, s12, s12 - g * s22, s22};
        const double actual[4] = {result.stress.m[0], result.stress.m[1], result.stress.m[3],
                                  result.stress.m[4]};
        for (int k = 0; k < 4; ++k)
            EXPECT_NEAR(actual[k], expected[k], closed_form_tolerance * std::abs(s12));
    }
}

INSTANTIATE_TEST_SUITE_P(EveryLaw, MaterialStretch, testing::ValuesIn(closed_forms()),
                         [](const auto& entry) {
                             std::string name = entry.param.law;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

TEST(MaterialStretches, HaveAClosedFormForEveryLaw) {
    for (const MaterialDescription& law : material_laws()) {
        int found = 0;
        for (const ClosedForm& form : closed_forms()) found += form.law == law.name;
        EXPECT_EQ(found, 1) << law.name;
    }
}

}  // namespace
}  // namespace palpate
