// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/session.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

constexpr std::size_t cpu_group_rows = 64;
constexpr std::size_t gpu_group_items = 128;
constexpr std::size_t gpu_group_columns = 16;
constexpr std::size_t most_gpu_parts = 256;       // every item adds up all parts: few, but enough
constexpr std::size_t work_per_cpu_part = 20000;  // some microseconds: far above handing it out
constexpr std::size_t smallest_buffer = 64;       // bytes: an empty buffer is an error in OpenCL
static_assert(gpu_group_items <= max_work_group_items && cpu_group_rows <= max_work_group_items);

}  // namespace

Session::Session(std::shared_ptr<OpenclDevice> device, Precision precision)
    : device_(std::move(device)), precision_(precision) {}

Session::~Session() {
    try {
        wait();
    } catch (const cl::Error&) {
        return;  // a device that failed was told where it did
    }
}

cl::Buffer Session::make_buffer(std::size_t bytes) const {
    if (bytes > device_->max_allocation)
        throw Error(ErrorCode::out_of_memory,
                    fmt::format("The device {} allows {} MiB in one piece, but {} MiB are needed: "
                                "use a coarser mesh, fewer columns or another device.",
                                device_->info.name, device_->max_allocation >> 20, bytes >> 20));
    return cl::Buffer(device_->context, CL_MEM_READ_WRITE, std::max(bytes, smallest_buffer));
}

cl::Buffer Session::upload_real(std::span<const double> values) const {
    const cl::Buffer buffer = make_real_buffer(values.size());
    write_real(values, buffer);
    return buffer;
}

void Session::write_real(std::span<const double> values, const cl::Buffer& buffer,
                         std::size_t first) const {
    if (values.empty()) return;
    if (is_double()) {
        device_->queue.enqueueWriteBuffer(buffer, CL_TRUE, first * sizeof(double),
                                          values.size_bytes(), values.data());
        return;
    }
    const std::vector<float> rounded(values.begin(), values.end());
    device_->queue.enqueueWriteBuffer(buffer, CL_TRUE, first * sizeof(float),
                                      rounded.size() * sizeof(float), rounded.data());
}

void Session::read_real(const cl::Buffer& buffer, std::span<double> values) const {
    if (values.empty()) return;
    if (is_double()) {
        device_->queue.enqueueReadBuffer(buffer, CL_TRUE, 0, values.size_bytes(), values.data());
        return;
    }
    std::vector<float> numbers(values.size());
    device_->queue.enqueueReadBuffer(buffer, CL_TRUE, 0, numbers.size() * sizeof(float),
                                     numbers.data());
    std::copy(numbers.begin(), numbers.end(), values.begin());
}

void Session::write_wide(std::span<const double> values, const cl::Buffer& buffer) const {
    if (values.empty()) return;
    if (device_->has_double) {
        device_->queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size_bytes(), values.data());
        return;
    }
    const std::vector<float> rounded(values.begin(), values.end());
    device_->queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, rounded.size() * sizeof(float),
                                      rounded.data());
}

std::vector<double> Session::read_wide(const cl::Buffer& buffer, std::size_t count) const {
    std::vector<double> values(count);
    if (count == 0) return values;
    if (device_->has_double) {
        device_->queue.enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(double), values.data());
        return values;
    }
    std::vector<float> numbers(count);
    device_->queue.enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(float), numbers.data());
    std::copy(numbers.begin(), numbers.end(), values.begin());
    return values;
}

std::vector<ColumnPass> Session::passes(std::size_t num_columns) const {
    return column_passes(num_columns, device_->is_cpu, is_double() ? 8 : 16);
}

std::size_t Session::most_parts() const {
    if (!device_->is_cpu) return most_gpu_parts;
    return std::clamp<std::size_t>(16 * std::max(device_->info.compute_units, 1), 16, 128);
}

std::size_t Session::num_parts(std::size_t rows, std::size_t work_per_row) const {
    const std::size_t parts =
        device_->is_cpu ? rows * work_per_row / work_per_cpu_part : rows / gpu_group_items;
    return std::clamp<std::size_t>(parts, 1, most_parts());
}

WorkGroup Session::group_of(GroupShape shape, const ColumnPass& pass) const {
    // A CPU runs one group per thread: long items stand alone, so that all threads get some.
    if (device_->is_cpu) return {1, shape == GroupShape::rows ? cpu_group_rows : 1};
    std::size_t columns = 1;
    while (columns < gpu_group_columns && columns < pass.groups) columns *= 2;
    return {columns, gpu_group_items / columns};
}

cl::Kernel& Session::kernel(const KernelName& name, const ColumnPass& pass,
                            const WorkGroup& group) {
    const KernelVariant& variant = name.variant;
    cl::Kernel& found = kernels_[{name.function, pass.width, group.columns, group.rows, variant}];
    if (found()) return found;
    std::vector<Define> defines = {{"REAL_IS_DOUBLE", is_double()},
                                   {"HAS_DOUBLE", device_->has_double},
                                   {"DEVICE_IS_CPU", device_->is_cpu},
                                   {"COLUMN_WIDTH", pass.width},
                                   {"WORK_GROUP_COLUMNS", static_cast<long>(group.columns)},
                                   {"WORK_GROUP_ROWS", static_cast<long>(group.rows)}};
    const std::pair<const char*, int> choices[] = {
        {"CONSTRAINED", variant.constrained},
        {"RECOMPUTED", variant.recomputed},
        {"MODE", variant.mode},
        {"HAS_SUM", variant.has_sum},
        {"BLOCK_ROWS", variant.block_rows},
        {"BLOCK_COLUMNS", variant.block_columns},
        {"LANES", variant.lanes},
        {"FROM_IS_DOUBLE", variant.from_is_double},
        {"NODES_PER_ELEMENT", variant.nodes_per_element},
        {"POINTS_PER_ELEMENT", variant.points_per_element},
        {"HAS_HOOP", variant.has_hoop},
        {"HAS_MEAN_VOLUME", variant.has_mean_volume}};
    for (const auto& [define, value] : choices)
        if (value >= 0) defines.push_back({define, value});
    found = cl::Kernel(device_->programs->get(name.program, variant.law, defines), name.function);
    return found;
}

}  // namespace palpate
