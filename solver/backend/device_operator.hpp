// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backend/device_vector.hpp"
#include "solver/model/block_matrix.hpp"

namespace palpate {

constexpr int max_block = 6;  ///< rows and columns of a block of any matrix

/// A linear map owned by a back end: the stiffness of its model, or a block matrix.
class DeviceOperator {
public:
    /// The stiffness of a model of `num_dofs`: 3x3 blocks and their inverted diagonal.
    explicit DeviceOperator(Index num_dofs)
        : rows_(num_dofs), columns_(num_dofs), is_stiffness_(true), has_inverse_diagonal_(true) {}
    /// An operator of the shape of `matrix`.
    DeviceOperator(const BlockMatrix& matrix, bool has_inverse_diagonal)
        : rows_(matrix.num_rows() * matrix.block_rows),
          columns_(matrix.num_columns * matrix.block_columns),
          block_rows_(matrix.block_rows),
          block_columns_(matrix.block_columns),
          num_blocks_(matrix.graph.items.size()),
          has_inverse_diagonal_(has_inverse_diagonal) {}
    virtual ~DeviceOperator() = default;
    DeviceOperator(const DeviceOperator&) = delete;
    DeviceOperator& operator=(const DeviceOperator&) = delete;

    Index rows() const { return rows_; }
    Index columns() const { return columns_; }
    int block_rows() const { return block_rows_; }
    int block_columns() const { return block_columns_; }
    std::size_t num_blocks() const { return num_blocks_; }  ///< of a matrix
    bool is_stiffness() const { return is_stiffness_; }
    bool has_inverse_diagonal() const { return has_inverse_diagonal_; }

private:
    Index rows_;
    Index columns_;
    int block_rows_ = 3;
    int block_columns_ = 3;
    std::size_t num_blocks_ = 0;
    bool is_stiffness_ = false;
    bool has_inverse_diagonal_;
};

/// What the rows of a product A x become: MODE of kernels/row_result.cl.
enum class RowResult {
    apply = 0,     ///< y = A x
    add = 1,       ///< y += A x
    residual = 2,  ///< y = b - A x
    smooth = 3,    ///< y = alpha x + beta y + weight D^-1 (b - A x); without the old y if beta == 0
};

/// One product with an operator, as a back end is asked for it.
struct OperatorProduct {
    RowResult result;
    const DeviceOperator& a;
    const DeviceVector& x;
    DeviceVector& y;                  ///< neither x nor b
    const DeviceVector* b = nullptr;  ///< residual and smooth
    double alpha = 0, beta = 0, weight = 0;
    DeviceSums* sum = nullptr;  ///< receives x_c . y_c (apply) or b_c . y_c (smooth), if given
};

}  // namespace palpate
