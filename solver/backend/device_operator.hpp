// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/types.hpp"

namespace palpate {

/// A linear map owned by a back end: the stiffness of its model, or a block matrix.
class DeviceOperator {
public:
    DeviceOperator(Index rows, Index columns) : rows_(rows), columns_(columns) {}
    virtual ~DeviceOperator() = default;
    DeviceOperator(const DeviceOperator&) = delete;
    DeviceOperator& operator=(const DeviceOperator&) = delete;

    Index rows() const { return rows_; }
    Index columns() const { return columns_; }

private:
    Index rows_;
    Index columns_;
};

}  // namespace palpate
