// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

private:
    Index rows_;
    Index columns_;
};

}  // namespace palpate
