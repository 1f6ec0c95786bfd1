// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include "solver/backend/backend.hpp"
#include "solver/backends/opencl/context.hpp"
#include "solver/backends/opencl/launch.hpp"

namespace palpate {

/// How much one work item has to do: a row, or many rows (a partial sum).
enum class ItemLength { one_row, many_rows };

/// Which kernel of which program; `constrained` is the define CONSTRAINED, -1 where there is none.
struct KernelName {
    const char* program;
    const char* function;
    int constrained = -1;
    ItemLength item_length = ItemLength::one_row;
};

/// One queue on one device at one precision: its buffers, copies and kernels. "Real" numbers are
/// float or double on the device and always double on the host.
class Session {
public:
    Session(std::shared_ptr<OpenclDevice> device, Precision precision);

    const OpenclDevice& device() const { return *device_; }
    Precision precision() const { return precision_; }
    bool is_double() const { return precision_ == Precision::double_; }
    std::size_t real_bytes() const { return is_double() ? sizeof(double) : sizeof(float); }

    /// Throws Error(out_of_memory) beyond the largest piece that the device allows.
    cl::Buffer make_buffer(std::size_t bytes) const;
    cl::Buffer make_real_buffer(std::size_t count) const {
        return make_buffer(count * real_bytes());
    }
    template <class T>
    cl::Buffer upload(const std::vector<T>& values) const;
    cl::Buffer upload_real(std::span<const double> values) const;
    void write_real(std::span<const double> values, const cl::Buffer& buffer) const;
    void read_real(const cl::Buffer& buffer, std::span<double> values) const;
    /// Reads sums of the device's widest type (`wide` of real.cl).
    std::vector<double> read_wide(const cl::Buffer& buffer, std::size_t count) const;
    std::size_t wide_bytes() const { return device_->has_double ? sizeof(double) : sizeof(float); }

    /// The passes that cover `num_columns` columns on this device at this precision.
    std::vector<ColumnPass> passes(std::size_t num_columns) const;
    /// Starts a kernel on `rows` x `pass.groups` items with `args` in the order of its parameters.
    template <class... Args>
    void run(const KernelName& name, std::size_t rows, const ColumnPass& pass, const Args&... args);
    void wait() { queue_.finish(); }

private:
    WorkGroup group_of(const KernelName& name, const ColumnPass& pass) const;
    cl::Kernel& kernel(const KernelName& name, const ColumnPass& pass);

    std::shared_ptr<OpenclDevice> device_;
    Precision precision_;
    cl::CommandQueue queue_;
    std::map<std::tuple<std::string_view, int, std::size_t, int>, cl::Kernel> kernels_;
};

/// A launch without columns: one item per row.
constexpr ColumnPass single_column = {0, 1, 1};

template <class T>
cl::Buffer Session::upload(const std::vector<T>& values) const {
    const std::size_t bytes = values.size() * sizeof(T);
    const cl::Buffer buffer = make_buffer(bytes);
    if (bytes > 0) queue_.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, values.data());
    return buffer;
}

template <class... Args>
void Session::run(const KernelName& name, std::size_t rows, const ColumnPass& pass,
                  const Args&... args) {
    launch(queue_, kernel(name, pass), WorkSize{pass.groups, rows, group_of(name, pass)}, args...);
}

}  // namespace palpate
