// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/finite_strain_law.hpp"

// Laws W = psi(x) + kappa/2 (J - 1)^2 in the reduced invariants x = J1 - 3, J1 = I1 I3^(-1/3), and
// J = sqrt(I3). At small strains x = 2 e:e, so the shear modulus is 2 psi'(0), the bulk modulus
// kappa.
namespace palpate {

/// psi and its first two derivatives by x, kPa.
template <typename Real>
struct Potential {
    Real value;
    Real first;
    Real second;
};

/// x = 3 ((I3 / (I1/3)^3)^(-1/3) - 1)
template <typename Real>
PALPATE_DEVICE Real distortion(const FiniteStrain<Real>& strain) {
    return 3 * expm1(-strain.log_distortion / 3);
}

/// I3^(-1/3) = J1 / I1
template <typename Real>
PALPATE_DEVICE Real reduced_scale(const FiniteStrain<Real>& strain, Real x) {
    return (1 + x / 3) / strain.square_stretch;
}

/// shear = 2 psi' I3^(-1/3) and pressure = kappa J (J - 1), with dx = 2 I3^(-1/3) (2 e : M).
template <typename Real>
PALPATE_DEVICE Response<Real> reduced_response(const FiniteStrain<Real>& strain, Real x,
                                               const Potential<Real>& psi, Real kappa) {
    const Real scale = reduced_scale(strain, x);
    const Real change = strain.volume_change;
    const Real stiff_volume = kappa * (1 + change);
    Response<Real> r;
    // W = psi(x) + kappa/2 (J - 1)^2, a = 2 psi' I3^(-1/3), b = kappa J (J - 1) (method.md, 8.1)
    r.energy = psi.value + kappa / 2 * change * change;
    r.shear = 2 * psi.first * scale;
    // da = 2 psi'' dx I3^(-1/3) - 2/3 a g, since I3^(-1/3) = J^(-2/3) and d ln J = g
    r.shear_by_distortion = 4 * psi.second * scale * scale;
    r.shear_by_volume = -2 * r.shear / 3;
    r.pressure = stiff_volume * change;
    // db = kappa (2 J - 1) J g
    r.pressure_by_volume = stiff_volume * (1 + 2 * change);
    r.pressure_by_strain = 0;
    return r;
}

/// psi and psi' by a parameter.
template <typename Real>
struct PotentialSlope {
    Real value;
    Real first;
};

/// The response by a parameter, from the derivatives of psi, psi' and kappa by it.
template <typename Real>
PALPATE_DEVICE ParameterResponse<Real> reduced_parameter_response(const FiniteStrain<Real>& strain,
                                                                  Real x,
                                                                  const PotentialSlope<Real>& psi,
                                                                  Real kappa) {
    const Real change = strain.volume_change;
    return {psi.value + kappa / 2 * change * change, 2 * psi.first * reduced_scale(strain, x),
            kappa * (1 + change) * change};
}

/// From psi to a response. A law derives from it and has `kappa`, `potential(x)`, and
/// `potential_slope(x, k)` and `kappa_slope(k)` by parameter k. There is no member here: devices
/// read a law's members in their order.
template <class Law, typename Real>
struct ReducedLaw : FiniteStrainLaw<Law, Real> {
    PALPATE_DEVICE Response<Real> response(const FiniteStrain<Real>& strain) const {
        const Real x = distortion(strain);
        return reduced_response(strain, x, reduced().potential(x), reduced().kappa);
    }

    PALPATE_DEVICE ParameterResponse<Real> parameter_response(const FiniteStrain<Real>& strain,
                                                              int k) const {
        const Real x = distortion(strain);
        return reduced_parameter_response(strain, x, reduced().potential_slope(x, k),
                                          reduced().kappa_slope(k));
    }

private:
    PALPATE_DEVICE const Law& reduced() const { return static_cast<const Law&>(*this); }
};

}  // namespace palpate
