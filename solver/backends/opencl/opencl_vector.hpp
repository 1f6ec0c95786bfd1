// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "solver/backends/opencl/session.hpp"

namespace palpate {

class OpenclVector final : public DeviceVector {
public:
    OpenclVector(Index rows, Index columns, cl::Buffer buffer, const Session* owner)
        : DeviceVector(rows, columns), buffer_(std::move(buffer)), owner_(owner) {}
    const cl::Buffer& buffer() const { return buffer_; }
    const Session* owner() const { return owner_; }
    std::size_t size() const { return static_cast<std::size_t>(rows()) * columns(); }

private:
    cl::Buffer buffer_;
    const Session* owner_;
};

/// Throws Error(invalid_argument) if `v` was not made by the back end of `session`.
const OpenclVector& vector_of(const DeviceVector& v, const Session& session);

}  // namespace palpate
