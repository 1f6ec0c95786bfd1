// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>
#include <variant>

#include "solver/materials/isochoric.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {

/// a W + b W_iso of any law of large strains, chosen at each call, with the interface of a law and
/// of what relaxes in a `ViscousStep`: one type for all laws, because loops over groups of elements
/// are large. a = 1, b = 0: the law; a = factor: `TotalRelaxation`; b = factor - 1:
/// `IsochoricRelaxation`.
template <typename Real>
struct GroupLaw : FiniteStrainLaw<GroupLaw<Real>, Real> {
    using Base = FiniteStrainLaw<GroupLaw<Real>, Real>;
    using Laws = std::variant<NeoHookeanLaw<Real>, NeoHookeanReducedLaw<Real>,
                              VerondaWestmannLaw<Real>, ReducedPolynomialLaw<Real>, YeohLaw<Real>>;
    using Whole = GroupLaw;
    using State = typename Base::State;

    const Laws* laws = nullptr;
    double of_all = 1, of_isochoric = 0;  ///< a, b
    bool relaxes_as_a_whole = false;

    Response<Real> response(const FiniteStrain<Real>& strain) const {
        Response<Real> found;
        visit_laws([&](const auto& law) { found = mixed(law, strain); });
        return found;
    }

    /// Of stresses; slopes of energies by parameters are not asked of groups.
    ParameterResponse<Real> parameter_response(const FiniteStrain<Real>& strain, int k) const {
        ParameterResponse<Real> found;
        visit_laws([&](const auto& law) { found = mixed_slope(law, strain, k); });
        return found;
    }

    /// What relaxes: W, or W_iso.
    GroupLaw part() const {
        GroupLaw one = *this;
        one.of_all = relaxes_as_a_whole ? 1 : 0;
        one.of_isochoric = relaxes_as_a_whole ? 0 : 1;
        return one;
    }
    State state_of_part(const State& s) const { return part().state_of(s.strain); }

private:
    template <class Law>
    Response<Real> mixed(const Law& law, const FiniteStrain<Real>& strain) const {
        const Real x = distortion(strain);
        Potential<Real> psi = law.potential(x);
        if constexpr (std::is_base_of_v<ReducedLaw<Law, Real>, Law>) {
            // a (psi + U) + b psi
            const Real both = of_all + of_isochoric;
            psi = {both * psi.value, both * psi.first, both * psi.second};
            return reduced_response(strain, x, psi, of_all * law.kappa);
        } else {
            Response<Real> sum{};
            sum = sum_of_responses(sum, Real(of_all), law.response(strain));
            if (of_isochoric == 0) return sum;
            return sum_of_responses(sum, Real(of_isochoric),
                                    reduced_response(strain, x, psi, Real(0)));
        }
    }
    template <class Law>
    ParameterResponse<Real> mixed_slope(const Law& law, const FiniteStrain<Real>& strain,
                                        int k) const {
        const Real x = distortion(strain);
        const PotentialSlope<Real> psi = law.potential_slope(x, k);
        ParameterResponse<Real> all;
        if constexpr (std::is_base_of_v<ReducedLaw<Law, Real>, Law>)
            all = reduced_parameter_response(strain, x, psi, law.kappa_slope(k));
        else
            all = law.parameter_response(strain, k);
        const ParameterResponse<Real> part = reduced_parameter_response(strain, x, psi, Real(0));
        return {0, of_all * all.shear + of_isochoric * part.shear,
                of_all * all.pressure + of_isochoric * part.pressure};
    }
    /// As std::visit, which compilers do not inline.
    template <std::size_t index = 0, class Visit>
    void visit_laws(const Visit& visit) const {
        if (const auto* law = std::get_if<index>(laws))
            visit(*law);
        else if constexpr (index + 1 < std::variant_size_v<Laws>)
            visit_laws<index + 1>(visit);
    }
};

}  // namespace palpate
