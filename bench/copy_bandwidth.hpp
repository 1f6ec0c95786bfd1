// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backend/backend.hpp"

namespace palpate::bench {

/// Bytes per second of a plain copy, read and written bytes counted, from one half of
/// `working_set_bytes` to the other: what a product that moves as many bytes could reach. Host
/// threads copy their own part again and again, so that what fits into a cache stays there.
/// Best of several tries.
double host_copy_bandwidth(double working_set_bytes);

/// The same between two vectors on the device of `backend`.
double device_copy_bandwidth(Backend& backend, double working_set_bytes);

}  // namespace palpate::bench
