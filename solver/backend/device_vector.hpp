// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "solver/base/types.hpp"

namespace palpate {

/// Numbers owned by a back end: `rows` x `columns`, stored row by row with the column index running
/// fastest, so that one pass over the mesh serves all columns with contiguous loads.
class DeviceVector {
public:
    DeviceVector(Index rows, Index columns) : rows_(rows), columns_(columns) {}
    virtual ~DeviceVector() = default;
    DeviceVector(const DeviceVector&) = delete;
    DeviceVector& operator=(const DeviceVector&) = delete;

    Index rows() const { return rows_; }
    Index columns() const { return columns_; }
    std::size_t size() const { return static_cast<std::size_t>(rows_) * columns_; }

private:
    Index rows_;
    Index columns_;
};

/// One number per column that stays on the device, as partial sums: what lets an iteration depend
/// on inner products without waiting for the host.
class DeviceSums {
public:
    explicit DeviceSums(Index columns) : columns_(columns) {}
    virtual ~DeviceSums() = default;
    DeviceSums(const DeviceSums&) = delete;
    DeviceSums& operator=(const DeviceSums&) = delete;

    Index columns() const { return columns_; }

private:
    Index columns_;
};

}  // namespace palpate
