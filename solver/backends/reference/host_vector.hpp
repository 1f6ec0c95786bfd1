// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>

#include "solver/backend/device_vector.hpp"
#include "solver/backend/own_argument.hpp"

namespace palpate::reference {

using HostValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A vector of the reference back end.
class HostVector final : public DeviceVector {
public:
    HostVector(Index rows, Index columns) : DeviceVector(rows, columns), values(rows, columns) {
        values.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    HostValues values;
};

inline const HostValues& values_of(const DeviceVector& v) {
    return own<const HostVector>(v).values;
}
inline HostValues& values_of(DeviceVector& v) { return own<HostVector>(v).values; }

}  // namespace palpate::reference
