// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/backend/backend.hpp"

namespace palpate {

/// A symmetric positive definite approximation of K^-1 on a device.
class Preconditioner {
public:
    virtual ~Preconditioner() = default;
    /// z = M r for every column, and the sums r_c . z_c.
    virtual void apply(const DeviceVector& r, DeviceVector& z, DeviceSums& rz) = 0;
    /// Forgets vectors of numbers of columns other than `columns`.
    virtual void keep_only(Index columns) = 0;
};

/// Inverse diagonal blocks of `matrix`, which `backend` has been given with them. Both outlive it.
std::unique_ptr<Preconditioner> make_block_jacobi(Backend& backend, const DeviceOperator& matrix);

/// `inner`, which belongs to the back end `single`, in conjugate gradients on the back end `outer`
/// of another precision on the same device: multigrid in single, everything else in double. Both
/// back ends outlive it.
std::unique_ptr<Preconditioner> make_precision_bridge(Backend& outer, Backend& single,
                                                      std::unique_ptr<Preconditioner> inner);

}  // namespace palpate
