// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>

#include "tests/fixtures/materials.hpp"

// One body for every law of the registry: what energy, stress, tangent and derivatives by
// parameters owe each other, whatever the formula is.
namespace palpate {
namespace {

using namespace fixtures;

constexpr int num_parameter_sets = 20;
constexpr int num_gradients = 50;              ///< for each set: 1,000 per law
constexpr double difference_tolerance = 1e-9;  ///< differences in 80-bit numbers, fourth order
constexpr double parameter_tolerance = 1e-8;   ///< the laws make their moduli in fp64
constexpr double rounding_tolerance = 1e-12;   ///< fp64, states conditioned up to 1e4
constexpr double single_tolerance = 1e-5;      ///< some tens of units in the last place of fp32
constexpr double small_size = 1e-6;            ///< |H| where laws must follow Hooke's
constexpr double linear_limit_tolerance = 30 * small_size;
constexpr long double difference_step = 3e-4L;       ///< of a gradient, relative below one
constexpr long double parameter_difference = 1e-4L;  ///< relative

using Wide = long double;

/// Fourth-order difference of f at 0.
template <class Function>
auto derivative(const Function& f, Wide step) {
    const auto difference = [&](Wide s) { return (f(s) - f(-s)) / (2 * s); };
    return (4 * difference(step / 2) - difference(step)) / 3;
}

Tensor3<Wide> moved(const Tensor3<Wide>& h, const Tensor3<Wide>& direction, Wide step) {
    Tensor3<Wide> to = h;
    for (int i = 0; i < 9; ++i) to.m[i] += step * direction.m[i];
    return to;
}

Wide step_at(const Tensor3<Wide>& h) { return difference_step * std::min(Wide(1), norm(h)); }

Tensor3<Wide> unit_tensor(int entry) {
    Tensor3<Wide> unit{};
    unit.m[entry] = 1;
    return unit;
}

template <typename Real>
double relative_difference(const Tensor3<Real>& actual, const Tensor3<Real>& expected) {
    Tensor3<Real> difference = actual;
    for (int i = 0; i < 9; ++i) difference.m[i] -= expected.m[i];
    return static_cast<double>(norm(difference) / norm(expected));
}

template <class Law>
double stress_error(const Law& law, const Tensor3<Wide>& h) {
    Tensor3<Wide> differences;
    for (int i = 0; i < 9; ++i)
        differences.m[i] = derivative(
            [&](Wide step) { return law.energy(law.state(moved(h, unit_tensor(i), step))); },
            step_at(h));
    return relative_difference(law.stress(law.state(h)), differences);
}

template <class Law>
double tangent_error(const Law& law, const Tensor3<Wide>& h, const Tensor3<Wide>& direction) {
    Tensor3<Wide> differences;
    for (int i = 0; i < 9; ++i)
        differences.m[i] = derivative(
            [&](Wide step) { return law.stress(law.state(moved(h, direction, step))).m[i]; },
            step_at(h));
    return relative_difference(law.tangent_apply(law.state(h), direction), differences);
}

class MaterialContract : public testing::TestWithParam<std::string> {
protected:
    const MaterialDescription& description = material_law(GetParam());
    std::mt19937 random{7};
    double worst = 0;

    void note(double error) { worst = std::isfinite(error) ? std::max(worst, error) : 1e300; }

    /// Calls `check(parameters, H)` for all samples: half moderate, half near rest.
    void for_each_sample(
        const std::function<void(const std::vector<double>&, const Tensor3<double>&)>& check) {
        for (int set = 0; set < num_parameter_sets; ++set) {
            const std::vector<double> parameters = random_parameters(description, random);
            for (int k = 0; k < num_gradients; ++k)
                check(parameters,
                      k % 2 == 0 ? moderate_gradient(random) : gradient_near_rest(random));
        }
    }
    template <typename Real, class Check>
    void for_each_law(const Check& check) {
        for_each_sample([&](const std::vector<double>& parameters, const Tensor3<double>& h) {
            with_material_law<Real>(GetParam(), parameters,
                                    [&](const auto& law) { check(law, tensor_cast<Real>(h)); });
        });
    }
    void expect_worst_below(double tolerance) {
        RecordProperty("worst", std::to_string(worst * 1e12) + "e-12");
        EXPECT_LE(worst, tolerance);
    }
    /// Hooke's law knows no rotations and no inversion.
    bool is_for_large_deformation() const { return GetParam() != "linear"; }
};

TEST_P(MaterialContract, StressIsTheDerivativeOfTheEnergy) {
    for_each_law<Wide>(
        [&](const auto& law, const Tensor3<Wide>& h) { note(stress_error(law, h)); });

    expect_worst_below(difference_tolerance);
}

TEST_P(MaterialContract, TangentIsTheDerivativeOfTheStress) {
    for_each_law<Wide>([&](const auto& law, const Tensor3<Wide>& h) {
        note(tangent_error(law, h, tensor_cast<Wide>(random_tensor(random))));
    });

    expect_worst_below(difference_tolerance);
}

TEST_P(MaterialContract, TangentIsSymmetric) {
    for_each_law<double>([&](const auto& law, const Tensor3<double>& h) {
        const auto state = law.state(h);
        const Tensor3<double> a = random_tensor(random), b = random_tensor(random);
        const Tensor3<double> at_b = law.tangent_apply(state, b);
        note(std::abs(double_dot(a, at_b) - double_dot(b, law.tangent_apply(state, a))) /
             (norm(a) * norm(at_b)));
    });

    expect_worst_below(rounding_tolerance);
}

TEST_P(MaterialContract, DoublesComputeWhatWiderNumbersDo) {
    for_each_sample([&](const std::vector<double>& parameters, const Tensor3<double>& h) {
        with_material_law<double>(GetParam(), parameters, [&](const auto& law) {
            with_material_law<Wide>(GetParam(), parameters, [&](const auto& wide) {
                const auto exact = wide.state(tensor_cast<Wide>(h));
                note(relative_difference(tensor_cast<Wide>(law.stress(law.state(h))),
                                         wide.stress(exact)));
                const Wide energy = wide.energy(exact);
                note(static_cast<double>(std::abs(law.energy(law.state(h)) - energy) / energy));
            });
        });
    });

    expect_worst_below(rounding_tolerance);
}

TEST_P(MaterialContract, RotationAfterwardsTurnsTheStressAndKeepsTheEnergy) {
    if (!is_for_large_deformation()) GTEST_SKIP() << "Hooke's law is for small rotations only.";
    for_each_law<double>([&](const auto& law, const Tensor3<double>&) {
        const Tensor3<double> h = moderate_gradient(random);
        const Mat3 q = random_rotation(random);
        const Mat3 turned = q * (matrix_of(h) + Mat3::Identity()) - Mat3::Identity();

        const auto before = law.state(h);
        const auto after = law.state(tensor_of(turned));

        note(std::abs(law.energy(after) / law.energy(before) - 1));
        note(relative_difference(law.stress(after), tensor_of(q * matrix_of(law.stress(before)))));
    });

    expect_worst_below(rounding_tolerance);
}

TEST_P(MaterialContract, FollowsHookesLawAtSmallStrains) {
    for_each_sample([&](const std::vector<double>& parameters, const Tensor3<double>& any) {
        const SmallStrainModuli moduli = small_strain_moduli(GetParam(), parameters);
        const LinearLaw<double> hooke = LinearLaw<double>::from_parameters(&moduli.stiffness_kpa);
        const Tensor3<double> h = scaled(any, small_size / norm(any));
        const Tensor3<double> expected = hooke.stress(hooke.state(h));
        const double scale = norm(hooke.tangent_apply(hooke.state(h), h));

        with_material_law<double>(GetParam(), parameters, [&](const auto& law) {
            const double energy = hooke.energy(hooke.state(h));
            note(relative_difference(law.stress(law.state(h)), expected) * norm(expected) / scale);
            note(std::abs(law.energy(law.state(h)) - energy) / energy);
        });
    });

    expect_worst_below(linear_limit_tolerance);
}

TEST_P(MaterialContract, HasExactlyNoEnergyOrStressAtRest) {
    with_material_law<float>(GetParam(), random_parameters(description, random),
                             [&](const auto& law) {
                                 const auto rest = law.state({});

                                 EXPECT_TRUE(rest.is_valid);
                                 EXPECT_EQ(law.energy(rest), 0.0f);
                                 EXPECT_EQ(norm(law.stress(rest)), 0.0f);
                             });
}

TEST_P(MaterialContract, DerivativesByParametersMatchDifferences) {
    for_each_sample([&](const std::vector<double>& parameters, const Tensor3<double>& sample) {
        const Tensor3<Wide> h = tensor_cast<Wide>(sample);
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            const auto at = [&](Wide step, const auto& value_of) {
                std::vector<double> changed = parameters;
                changed[k] = static_cast<double>(parameters[k] * (1 + step));
                Wide value = 0;
                with_material_law<Wide>(GetParam(), changed, [&](const auto& law) {
                    value = value_of(law, law.state(h));
                });
                return value;
            };
            const auto by_parameter = [&](const auto& value_of) {
                return derivative([&](Wide step) { return at(step, value_of); },
                                  parameter_difference) /
                       parameters[k];
            };
            Tensor3<Wide> stress;
            for (int i = 0; i < 9; ++i)
                stress.m[i] = by_parameter(
                    [i](const auto& law, const auto& state) { return law.stress(state).m[i]; });
            const Wide energy =
                by_parameter([](const auto& law, const auto& state) { return law.energy(state); });

            with_material_law<Wide>(GetParam(), parameters, [&](const auto& law) {
                const auto state = law.state(h);
                const int parameter = static_cast<int>(k);
                const Wide scale = norm(law.stress(state)) / parameters[k];
                // Not over `stress`: near rest a parameter of high order has none.
                Tensor3<Wide> difference = law.parameter_stress(state, parameter);
                for (int i = 0; i < 9; ++i) difference.m[i] -= stress.m[i];
                note(static_cast<double>(norm(difference) / scale));
                note(static_cast<double>(std::abs(law.parameter_energy(state, parameter) - energy) *
                                         parameters[k] / law.energy(state)));
            });
        }
    });

    expect_worst_below(parameter_tolerance);
}

TEST_P(MaterialContract, SinglePrecisionKeepsItsDigitsNearRest) {
    for_each_sample([&](const std::vector<double>& parameters, const Tensor3<double>&) {
        const Tensor3<float> h = tensor_cast<float>(gradient_near_rest(random));
        with_material_law<float>(GetParam(), parameters, [&](const auto& single) {
            with_material_law<double>(GetParam(), parameters, [&](const auto& exact) {
                const auto coarse = single.state(h);
                const auto fine = exact.state(tensor_cast<double>(h));
                note(relative_difference(tensor_cast<double>(single.stress(coarse)),
                                         exact.stress(fine)));
                note(std::abs(single.energy(coarse) / exact.energy(fine) - 1));
                const Tensor3<float> direction = tensor_cast<float>(random_tensor(random));
                note(relative_difference(
                    tensor_cast<double>(single.tangent_apply(coarse, direction)),
                    exact.tangent_apply(fine, tensor_cast<double>(direction))));
            });
        });
    });

    expect_worst_below(single_tolerance);
}

template <class Law, typename Real>
void expect_reported_as_not_valid(const Law& law, const Tensor3<Real>& h) {
    const auto state = law.state(h);

    EXPECT_FALSE(state.is_valid);
    EXPECT_EQ(law.energy(state), std::numeric_limits<Real>::infinity());
    EXPECT_EQ(norm(law.stress(state)), 0);
    EXPECT_EQ(norm(law.tangent_apply(state, Tensor3<Real>{{1, 2, 3, 4, 5, 6, 7, 8, 9}})), 0);
    EXPECT_EQ(norm(law.parameter_stress(state, 0)), 0);
    EXPECT_EQ(law.parameter_energy(state, 0), 0);
}

TEST_P(MaterialContract, InvertedCrushedAndEndlessStatesAreReported) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double inf = std::numeric_limits<double>::infinity();
    std::vector<Tensor3<double>> states = {{{nan, 0, 0, 0, 0, 0, 0, 0, 0}},
                                           {{0, inf, 0, 0, 0, 0, 0, 0, 0}},
                                           {{1e30, 0, 0, 0, 1e30, 0, 0, 0, 1e30}}};
    if (is_for_large_deformation()) {
        states.push_back({{-2, 0, 0, 0, 0, 0, 0, 0, 0}});
        states.push_back({{-1, 0, 0, 0, 0, 0, 0, 0, 0}});
        states.push_back({{-1, 0, 0, 0, -1, 0, 0, 0, -1}});
        states.push_back({{-2, 0, 0, 0, -2, 0, 0, 0, -2}});
    }
    const std::vector<double> parameters = random_parameters(description, random);

    for (const Tensor3<double>& h : states) {
        with_material_law<double>(GetParam(), parameters,
                                  [&](const auto& law) { expect_reported_as_not_valid(law, h); });
        with_material_law<float>(GetParam(), parameters, [&](const auto& law) {
            expect_reported_as_not_valid(law, tensor_cast<float>(h));
        });
    }
}

TEST_P(MaterialContract, NothingIsNanInAnyStateOfSinglePrecision) {
    std::uniform_real_distribution<double> exponent(-8, 4);
    int num_valid = 0;
    for (int k = 0; k < 20000; ++k) {
        const Tensor3<float> h =
            tensor_cast<float>(scaled(random_tensor(random), std::pow(10.0, exponent(random))));
        with_material_law<float>(
            GetParam(), random_parameters(description, random), [&](const auto& law) {
                const auto state = law.state(h);
                num_valid += state.is_valid;
                EXPECT_EQ(std::isfinite(law.energy(state)), state.is_valid);
                for (float entry : law.stress(state).m) EXPECT_TRUE(std::isfinite(entry));
                const auto dp = law.tangent_apply(state, tensor_cast<float>(random_tensor(random)));
                for (float entry : dp.m) EXPECT_TRUE(std::isfinite(entry));
            });
    }
    EXPECT_GT(num_valid, 10000);
}

INSTANTIATE_TEST_SUITE_P(EveryLaw, MaterialContract, testing::ValuesIn(material_names()),
                         [](const auto& entry) {
                             std::string name = entry.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

/// A law whose stress is off by one in ten thousand.
struct BrokenLaw : NeoHookeanLaw<Wide> {
    Tensor3<Wide> stress(const State& state) const {
        return scaled(NeoHookeanLaw<Wide>::stress(state), Wide(1.0001));
    }
};

TEST(MaterialContractCheck, CatchesAWrongStress) {
    std::mt19937 random(3);
    BrokenLaw law;
    law.lame = lame_moduli<Wide>(10, 0.45);

    EXPECT_GT(stress_error(law, tensor_cast<Wide>(moderate_gradient(random))),
              100 * difference_tolerance);
}

// Why the laws take H and not F: in the formula of the textbook nothing is left of the energy.
TEST(MaterialContractCheck, TextbookFormHasNoDigitsNearRest) {
    const float h = 1e-5f;
    const float f = 1 + h;

    const float textbook = 0.5f * (f * f + 2 - 3 - 2 * std::log(f));

    EXPECT_GT(std::abs(textbook / (h * h) - 1), 0.1f);
}

}  // namespace
}  // namespace palpate
