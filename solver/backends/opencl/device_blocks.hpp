// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "solver/backend/device_operator.hpp"
#include "solver/backends/opencl/session.hpp"
#include "solver/model/block_matrix.hpp"

namespace palpate {

/// One product and where its rows go.
struct RowJob {
    RowResult result = RowResult::apply;
    const cl::Buffer* x = nullptr;
    const cl::Buffer* y = nullptr;
    const cl::Buffer* b = nullptr;  ///< residual and smooth
    double alpha = 0, beta = 0, weight = 0;
    const cl::Buffer* sum = nullptr;  ///< parts of x . y (apply) or b . y (smooth), if wanted
    std::size_t num_columns = 1;
};

/// A matrix of 3x3, 3x6, 6x3 or 6x6 blocks on the device (kernels/multiply_blocks.cl).
class DeviceBlocks {
public:
    /// Room for the pattern; values come from `set_values` or from a kernel.
    DeviceBlocks(const Session& session, const Adjacency& graph, int block_rows, int block_columns,
                 bool is_square);

    Index num_rows() const { return num_rows_; }
    int block_rows() const { return block_rows_; }
    int block_columns() const { return block_columns_; }
    bool is_square() const { return is_square_; }
    std::size_t num_blocks() const { return num_blocks_; }

    const cl::Buffer& row_start() const { return row_start_; }
    const cl::Buffer& block_node() const { return block_node_; }
    const cl::Buffer& blocks() const { return blocks_; }
    const cl::Buffer& inverse_diagonal() const { return inverse_diagonal_; }

    void set_values(const Session& session, const BlockMatrix& matrix,
                    std::span<const double> inverse_diagonal);
    /// Runs the product; returns the number of parts that `job.sum` then holds.
    std::size_t run(Session& session, const RowJob& job) const;

private:
    Index num_rows_;
    int block_rows_, block_columns_;
    bool is_square_;
    std::size_t num_blocks_;
    cl::Buffer row_start_, block_node_, blocks_, inverse_diagonal_;
};

/// z = weight D^-1 r with the inverted blocks [num_rows, block, block] of a diagonal; returns the
/// number of parts of r . z in `sum`, if given.
std::size_t multiply_diagonal(Session& session, const cl::Buffer& inverse_diagonal, Index num_rows,
                              int block, double weight, const cl::Buffer& r, const cl::Buffer& z,
                              const cl::Buffer* sum, std::size_t num_columns);

/// Calls `call` with a function that turns numbers into the kernels' real type.
template <class Call>
void with_real(const Session& session, Call&& call) {
    if (session.is_double())
        call([](double value) { return static_cast<cl_double>(value); });
    else
        call([](double value) { return static_cast<cl_float>(value); });
}

}  // namespace palpate
