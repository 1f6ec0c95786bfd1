// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

// Inside palpate: mm, kPa, mN. Programs without units get mm, MPa and N, the usual consistent set
// of engineers; 1 MPa = 1 N/mm2 = 1000 kPa. The only place where palpate leaves its own units.
constexpr double mpa_from_kpa(double kpa) { return kpa / 1000; }
constexpr double newton_from_mn(double millinewton) { return millinewton / 1000; }

}  // namespace palpate
