// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/device_blocks.hpp"

#include <algorithm>

#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr std::size_t block_padding = 4;  // reals that multiply_blocks.cl may read past the end
constexpr Index blocks_per_thread = 5000;
constexpr Index blocks_per_write = 1 << 18;  // bounds the copies on the host

/// The blocks [first, last) column by column, as the kernels read them.
std::vector<double> column_by_column(const BlockMatrix& matrix, Index first, Index last) {
    const int rows = matrix.block_rows, columns = matrix.block_columns;
    std::vector<double> turned(static_cast<std::size_t>(last - first) * rows * columns);
    parallel_ranges(last - first, blocks_per_thread, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) {
            const double* from = matrix.block(first + k);
            double* to = turned.data() + static_cast<std::size_t>(k) * rows * columns;
            for (int i = 0; i < rows; ++i)
                for (int j = 0; j < columns; ++j) to[rows * j + i] = from[columns * i + j];
        }
    });
    return turned;
}

}  // namespace

DeviceBlocks::DeviceBlocks(const Session& session, const Adjacency& graph, int block_rows,
                           int block_columns, bool is_square)
    : num_rows_(graph.num_lists()),
      block_rows_(block_rows),
      block_columns_(block_columns),
      is_square_(is_square),
      num_blocks_(graph.items.size()),
      row_start_(session.upload(graph.offsets)),
      block_node_(session.upload(graph.items)),
      blocks_(session.make_real_buffer(num_blocks_ * block_rows * block_columns + block_padding)),
      inverse_diagonal_(session.make_real_buffer(
          is_square ? static_cast<std::size_t>(num_rows_) * block_rows * block_rows : 0)) {}

void DeviceBlocks::set_values(const Session& session, const BlockMatrix& matrix,
                              std::span<const double> inverse_diagonal) {
    const Index count = static_cast<Index>(num_blocks_);
    for (Index first = 0; first < count; first += blocks_per_write)
        session.write_real(
            column_by_column(matrix, first, std::min(count, first + blocks_per_write)), blocks_,
            static_cast<std::size_t>(first) * matrix.block_size());
    if (is_square_) session.write_real(inverse_diagonal, inverse_diagonal_);
}

std::size_t DeviceBlocks::run(Session& session, const RowJob& job) const {
    const int mode = static_cast<int>(job.result);
    const KernelName name = {"multiply_blocks", "multiply_blocks",
                             KernelVariant{.mode = mode,
                                           .has_sum = job.sum != nullptr,
                                           .block_rows = block_rows_,
                                           .block_columns = block_columns_}};
    const std::size_t blocks_per_row = num_blocks_ / std::max<Index>(num_rows_, 1) + 1;
    const std::size_t parts = session.num_parts(
        num_rows_, blocks_per_row * block_rows_ * block_columns_ * job.num_columns);
    with_real(session, [&](auto real) {
        for (const ColumnPass& pass : session.passes(job.num_columns))
            session.run_parts(name, parts, pass, row_start_, block_node_, blocks_,
                              inverse_diagonal_, job.b ? *job.b : *job.x, *job.x, *job.y,
                              real(job.alpha), real(job.beta), real(job.weight),
                              job.sum ? *job.sum : *job.y, cl_int(num_rows_),
                              cl_int(job.num_columns), cl_int(pass.first));
    });
    return parts;
}

std::size_t multiply_diagonal(Session& session, const cl::Buffer& inverse_diagonal, Index num_rows,
                              int block, double weight, const cl::Buffer& r, const cl::Buffer& z,
                              const cl::Buffer* sum, std::size_t num_columns) {
    const KernelName name = {"inverse_diagonal", "apply_inverse_diagonal",
                             KernelVariant{.has_sum = sum != nullptr, .block_rows = block}};
    const std::size_t parts = session.num_parts(num_rows, std::size_t(block) * block * num_columns);
    with_real(session, [&](auto real) {
        for (const ColumnPass& pass : session.passes(num_columns))
            session.run_parts(name, parts, pass, inverse_diagonal, r, z, real(weight),
                              sum ? *sum : z, cl_int(num_rows), cl_int(num_columns),
                              cl_int(pass.first));
    });
    return parts;
}

}  // namespace palpate
