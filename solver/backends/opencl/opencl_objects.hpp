// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "solver/backend/own_argument.hpp"
#include "solver/backends/opencl/device_blocks.hpp"
#include "solver/backends/opencl/session.hpp"

// What the OpenCL back end of one session makes for its callers.
namespace palpate {

class OpenclVector final : public DeviceVector {
public:
    OpenclVector(Index rows, Index columns, cl::Buffer buffer, const Session& owner)
        : DeviceVector(rows, columns), buffer_(std::move(buffer)), owner_(owner) {}
    const cl::Buffer& buffer() const { return buffer_; }
    const Session& owner() const { return owner_; }

private:
    cl::Buffer buffer_;
    const Session& owner_;
};

class OpenclSums final : public DeviceSums {
public:
    OpenclSums(Index columns, cl::Buffer buffer, const Session& owner)
        : DeviceSums(columns), buffer_(std::move(buffer)), owner_(owner) {}
    const cl::Buffer& buffer() const { return buffer_; }
    const Session& owner() const { return owner_; }
    std::size_t num_parts = 0;  ///< rows of the buffer that hold the sums

private:
    cl::Buffer buffer_;
    const Session& owner_;
};

/// A block matrix, or the stiffness of the back end's model (then without blocks of its own).
class OpenclOperator final : public DeviceOperator {
public:
    OpenclOperator(Index num_dofs, const Session& owner)
        : DeviceOperator(num_dofs), owner_(owner) {}
    OpenclOperator(const BlockMatrix& matrix, bool has_inverse_diagonal, const Session& owner)
        : DeviceOperator(matrix, has_inverse_diagonal), owner_(owner) {}
    const Session& owner() const { return owner_; }
    std::optional<DeviceBlocks> blocks;

private:
    const Session& owner_;
};

/// `argument` as what the back end of `session` makes. Throws Error(invalid_argument) if another
/// made it.
template <class Own, class Argument>
Own& own_of(const Session& session, Argument& argument) {
    Own& found = own<Own>(argument);
    if (&found.owner() != &session) refuse_foreign_argument();
    return found;
}

}  // namespace palpate
