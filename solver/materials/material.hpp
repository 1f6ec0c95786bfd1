// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "solver/base/tensor3.hpp"

namespace palpate {

/// Values that a parameter may take.
struct ParameterRange {
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    bool includes_lowest = false;
    bool includes_highest = false;

    /// False for NaN and for an infinite value too.
    bool contains(double value) const {
        return (value > lowest || (includes_lowest && value == lowest)) &&
               (value < highest || (includes_highest && value == highest));
    }
};

constexpr ParameterRange above(double lowest) { return {.lowest = lowest}; }
constexpr ParameterRange at_least(double lowest) {
    return {.lowest = lowest, .includes_lowest = true};
}

struct MaterialParameter {
    std::string_view name;  ///< as in settings, with its unit: "mu_kpa"
    std::string_view unit;  ///< "kPa", "1/kPa" or "1"
    ParameterRange range;
    std::string_view meaning;
    /// Of soft tissue, and how far one differs from another (sd of the logarithm; of the logit
    /// within two ends): what is assumed of a parameter that is looked for. 0: nothing is.
    double typical = 0, typical_sd = 1.5;
};

/// What a user may know about a law: its row in `material_laws()`.
struct MaterialDescription {
    std::string_view name;  ///< "neo-hookean"
    std::string_view sentence;
    std::vector<MaterialParameter> parameters;  ///< in the order of `from_parameters`
};

/// The moduli of Hooke's law that a material follows at small strains.
struct SmallStrainModuli {
    double stiffness_kpa = 0;
    double poisson_ratio = 0;
};

constexpr SmallStrainModuli moduli_of_shear_and_bulk(double shear_kpa, double bulk_kpa) {
    return {9 * bulk_kpa * shear_kpa / (3 * bulk_kpa + shear_kpa),
            (3 * bulk_kpa - 2 * shear_kpa) / (2 * (3 * bulk_kpa + shear_kpa))};
}
/// G = E / (2 (1 + nu)), kPa.
constexpr double shear_modulus(const SmallStrainModuli& moduli) {
    return moduli.stiffness_kpa / (2 * (1 + moduli.poisson_ratio));
}
/// K = E / (3 (1 - 2 nu)), kPa.
constexpr double bulk_modulus(const SmallStrainModuli& moduli) {
    return moduli.stiffness_kpa / (3 * (1 - 2 * moduli.poisson_ratio));
}

/// A material law: plain numbers, to be copied into kernels. `parameters_of(moduli)` are parameters
/// with which it follows these at small strains, and as typical as that allows in all else. Input
/// is always the displacement gradient H = F - I, because F - I loses near rest what single
/// precision has.
///   state(H)                    what the functions below share; look at `is_valid` first
///   energy(state)               W, kPa; infinite where the state is not valid
///   stress(state)               first Piola stress P = dW/dF, kPa; zero where not valid
///   tangent_apply(state, dF)    dP = d2W/dF2 : dF, kPa; zero where not valid
///   parameter_energy(state, k)  dW by parameter k, in kPa per unit of the parameter
///   parameter_stress(state, k)  dP by parameter k
/// A state is not valid where matter is inverted or crushed, or numbers would overflow.
template <class Law>
concept Material = requires(const Law law, const typename Law::State state,
                            const Tensor3<typename Law::Number> tensor, const double* values,
                            int parameter) {
    { Law::description() } -> std::same_as<MaterialDescription>;
    { Law::from_parameters(values) } -> std::same_as<Law>;
    { Law::small_strain(values) } -> std::same_as<SmallStrainModuli>;
    { Law::parameters_of(SmallStrainModuli{}) } -> std::same_as<std::vector<double>>;
    { law.state(tensor) } -> std::same_as<typename Law::State>;
    { state.is_valid } -> std::convertible_to<bool>;
    { law.energy(state) } -> std::same_as<typename Law::Number>;
    { law.stress(state) } -> std::same_as<Tensor3<typename Law::Number>>;
    { law.tangent_apply(state, tensor) } -> std::same_as<Tensor3<typename Law::Number>>;
    { law.parameter_energy(state, parameter) } -> std::same_as<typename Law::Number>;
    { law.parameter_stress(state, parameter) } -> std::same_as<Tensor3<typename Law::Number>>;
};

}  // namespace palpate
