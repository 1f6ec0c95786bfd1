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

/// How the rows of a launch become work items.
enum class RowShare {
    one_each,   ///< one item per row
    long_items  ///< one item per row, each with much to do
};

/// Defines of a kernel beyond number types and layout; -1: the kernel does not know the define.
struct KernelVariant {
    int constrained = -1;
    int recomputed = -1;
    int mode = -1;
    int has_sum = -1;
    int block_rows = -1;
    int block_columns = -1;
    int lanes = -1;
    int from_is_double = -1;
    int nodes_per_element = -1;
    int points_per_element = -1;
    int has_hoop = -1;
    int has_mean_volume = -1;
    std::string_view law = "linear";  ///< of programs that exist for every law

    // clang-tidy 14 takes the zero of a comparison for a pointer.
    auto operator<=>(const KernelVariant&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// Which kernel of which program.
struct KernelName {
    const char* program;
    const char* function;
    KernelVariant variant = {};
    RowShare share = RowShare::one_each;
};

/// One queue on one device at one precision: its buffers, copies and kernels. "Real" numbers are
/// float or double on the device and always double on the host.
class Session {
public:
    Session(std::shared_ptr<OpenclDevice> device, Precision precision);
    /// Waits for what was launched. PoCL compiles a kernel when it first runs, on a thread of its
    /// own; a process that ended meanwhile was aborted by it.
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const OpenclDevice& device() const { return *device_; }
    OpenclDevice& device() { return *device_; }
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
    /// `first`: where in the buffer, in reals.
    void write_real(std::span<const double> values, const cl::Buffer& buffer,
                    std::size_t first = 0) const;
    void read_real(const cl::Buffer& buffer, std::span<double> values) const;
    /// Sums of the device's widest type (`wide` of real.cl).
    void write_wide(std::span<const double> values, const cl::Buffer& buffer) const;
    /// Reads sums of the device's widest type (`wide` of real.cl).
    std::vector<double> read_wide(const cl::Buffer& buffer, std::size_t count) const;
    std::size_t wide_bytes() const { return device_->has_double ? sizeof(double) : sizeof(float); }

    /// The passes that cover `num_columns` columns on this device at this precision.
    std::vector<ColumnPass> passes(std::size_t num_columns) const;
    /// Starts a kernel on `rows` x `pass.groups` items with `args` in the order of its parameters.
    template <class... Args>
    void run(const KernelName& name, std::size_t rows, const ColumnPass& pass, const Args&... args);
    /// Starts a kernel over parts (kernels/parts.cl) on `num_parts` work groups per column group.
    template <class... Args>
    void run_parts(const KernelName& name, std::size_t num_parts, const ColumnPass& pass,
                   const Args&... args);
    /// Into how many parts to cut `rows` rows of `work_per_row` multiply-adds each.
    std::size_t num_parts(std::size_t rows, std::size_t work_per_row) const;
    /// The most that `num_parts` returns on this device.
    std::size_t most_parts() const;
    void wait() const { device_->queue.finish(); }

private:
    enum class GroupShape { rows, single_item, part };

    WorkGroup group_of(GroupShape shape, const ColumnPass& pass) const;
    cl::Kernel& kernel(const KernelName& name, const ColumnPass& pass, const WorkGroup& group);

    std::shared_ptr<OpenclDevice> device_;
    Precision precision_;
    std::map<std::tuple<std::string_view, int, std::size_t, std::size_t, KernelVariant>, cl::Kernel>
        kernels_;
};

/// A launch without columns: one item per row.
constexpr ColumnPass single_column = {0, 1, 1};

template <class T>
cl::Buffer Session::upload(const std::vector<T>& values) const {
    const std::size_t bytes = values.size() * sizeof(T);
    const cl::Buffer buffer = make_buffer(bytes);
    if (bytes > 0) device_->queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, values.data());
    return buffer;
}

template <class... Args>
void Session::run(const KernelName& name, std::size_t rows, const ColumnPass& pass,
                  const Args&... args) {
    const WorkGroup group = group_of(
        name.share == RowShare::one_each ? GroupShape::rows : GroupShape::single_item, pass);
    launch(device_->queue, kernel(name, pass, group), WorkSize{pass.groups, rows, group}, args...);
}

template <class... Args>
void Session::run_parts(const KernelName& name, std::size_t num_parts, const ColumnPass& pass,
                        const Args&... args) {
    const WorkGroup group = group_of(GroupShape::part, pass);
    launch(device_->queue, kernel(name, pass, group),
           WorkSize{pass.groups, num_parts * group.rows, group}, args...);
}

}  // namespace palpate
