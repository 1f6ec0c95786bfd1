// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Laws W = psi(x) + kappa/2 (J - 1)^2 with x = I1 I3^(-1/3) - 3:
//   shear = 2 psi' I3^(-1/3),  pressure = kappa J (J - 1),  dx = 2 I3^(-1/3) (2 e : M)
static inline real distortion(const finite_strain* s) { return 3 * expm1(-s->log_distortion / 3); }

// I3^(-1/3)
static inline real reduced_scale(const finite_strain* s, real x) {
    return (1 + x / 3) / s->square_stretch;
}

static inline response reduced_response(const finite_strain* s, real x, real psi, real psi_first,
                                        real psi_second, real kappa) {
    const real scale = reduced_scale(s, x);
    const real change = s->volume_change;
    const real stiff_volume = kappa * (1 + change);
    response r;
    r.energy = psi + kappa / 2 * change * change;
    r.shear = 2 * psi_first * scale;
    r.shear_by_distortion = 4 * psi_second * scale * scale;
    r.shear_by_volume = -2 * r.shear / 3;
    r.pressure = stiff_volume * change;
    r.pressure_by_volume = stiff_volume * (1 + 2 * change);
    r.pressure_by_strain = 0;
    return r;
}

// From the derivatives of psi, psi' and kappa by a parameter.
static inline parameter_response reduced_parameter_response(const finite_strain* s, real x,
                                                            real psi, real psi_first, real kappa) {
    const real change = s->volume_change;
    parameter_response r;
    r.energy = psi + kappa / 2 * change * change;
    r.shear = 2 * psi_first * reduced_scale(s, x);
    r.pressure = kappa * (1 + change) * change;
    return r;
}
