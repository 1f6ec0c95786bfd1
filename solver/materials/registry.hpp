// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "solver/materials/linear_law.hpp"
#include "solver/materials/material.hpp"
#include "solver/materials/neo_hookean.hpp"
#include "solver/materials/neo_hookean_reduced.hpp"
#include "solver/materials/reduced_polynomial.hpp"
#include "solver/materials/veronda_westmann.hpp"
#include "solver/materials/yeoh.hpp"

namespace palpate {

/// Every law; a new one is one more line here and its twin in kernels/materials.
template <typename Real>
using MaterialLaws = std::tuple<LinearLaw<Real>,             //
                                NeoHookeanLaw<Real>,         //
                                NeoHookeanReducedLaw<Real>,  //
                                VerondaWestmannLaw<Real>,    //
                                ReducedPolynomialLaw<Real>,  //
                                YeohLaw<Real>>;

/// The one table of laws and parameters that settings, messages, help and reports read.
const std::vector<MaterialDescription>& material_laws();

/// Throws Error(invalid_argument) for an unknown name, with the names that there are.
const MaterialDescription& material_law(std::string_view name);

/// What a parameter may be: "above 0 kPa (bulk modulus at small strains)".
std::string allowed_text(const MaterialParameter& parameter);

/// Throws Error(invalid_argument) that names law, parameter, value and what is allowed.
void check_parameters(const MaterialDescription& law, std::span<const double> values);

namespace detail {

template <class Law, class Visit>
bool visit_if_named(std::string_view name, std::span<const double> values, Visit& visit) {
    static_assert(Material<Law>);
    if (Law::description().name != name) return false;
    visit(Law::from_parameters(values.data()));
    return true;
}

}  // namespace detail

/// Calls `visit(law)` with the law of that name and these parameters, checked, in numbers `Real`.
template <typename Real, class Visit>
void with_material_law(std::string_view name, std::span<const double> values, Visit&& visit) {
    check_parameters(material_law(name), values);
    [&]<class... Laws>(const std::tuple<Laws...>*) {
        (detail::visit_if_named<Laws>(name, values, visit) || ...);
    }(static_cast<MaterialLaws<Real>*>(nullptr));
}

/// The Hooke's law that a law follows at small strains.
SmallStrainModuli small_strain_moduli(std::string_view name, std::span<const double> values);

/// Parameters with which a law follows these moduli at small strains; what they leave open is
/// typical of soft tissue. Throws Error(invalid_argument) for moduli that the law cannot follow.
std::vector<double> parameters_of_moduli(std::string_view name, const SmallStrainModuli& moduli);

/// Of the material that differs in Young's modulus alone: energy, stress and tangent are multiplied
/// by the ratio of the moduli.
std::vector<double> parameters_of_stiffness(std::string_view name, std::span<const double> values,
                                            double stiffness_kpa);

/// The numbers of a law as kernels read them: its members in order, made in fp64.
std::vector<double> material_coefficients(std::string_view name, std::span<const double> values);

}  // namespace palpate
