// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "solver/backend/device_vector.hpp"
#include "solver/base/error.hpp"

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
    return dynamic_cast<const HostVector&>(v).values;
}
inline HostValues& values_of(DeviceVector& v) { return dynamic_cast<HostVector&>(v).values; }

inline void require(bool holds, const char* function, const char* what) {
    if (!holds)
        throw Error(ErrorCode::invalid_argument,
                    std::string("Back end reference, ") + function + ": " + what + ".");
}

inline void require_same_shape(const DeviceVector& x, const DeviceVector& y, const char* function) {
    require(x.rows() == y.rows() && x.columns() == y.columns(), function,
            "the vectors differ in rows or columns");
}

}  // namespace palpate::reference
