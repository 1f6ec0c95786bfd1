// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "solver/linear/multigrid/aggregates.hpp"
#include "solver/model/block_matrix.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// One level of a multigrid hierarchy. Level 0 is the mesh, 3 dofs per node; below it every node is
/// an aggregate with 6 dofs.
struct MultigridLevel {
    BlockMatrix matrix;                    ///< 6x6 blocks; empty on level 0
    std::vector<double> inverse_diagonal;  ///< [num_nodes, b, b], inverted diagonal blocks D^-1
    double largest_eigenvalue = 0;         ///< of D^-1 A, estimated from below
    Aggregates aggregates;                 ///< nodes of the next level
    BlockMatrix prolongation;              ///< [nodes here, nodes of the next level], b x 6 blocks
    BlockMatrix product;                   ///< pattern of A P; its values come and go
    Adjacency members;                     ///< rows of `prolongation` per block column
    std::vector<Index> member_entries;     ///< and their entries in it
    Eigen::MatrixXd modes;                 ///< [b num_nodes, 6] near-null space
};

/// Smoothed aggregation for elasticity (Vanek, Mandel, Brezina, Computing 56, 1996): the columns of
/// the tentative prolongation are the rigid-body modes of each aggregate, orthonormalised; one
/// damped Jacobi step smooths them; coarse matrices are P^T A P. Moduli do not enter the choice of
/// aggregates: when they change, `update` recomputes values in place.
class Hierarchy {
public:
    /// Levels are added until the coarsest has at most this many dofs.
    static constexpr Index coarsest_dofs = 600;

    /// `stiffness` has 3x3 blocks, without regard to prescribed dofs.
    ///   nodes       [num_nodes] mm; in a plane the third component of every dof is prescribed
    ///   prescribed  [3 num_nodes]
    /// Throws Error(solve_failed) if the coarsest matrix is not positive definite.
    Hierarchy(std::span<const Vec3> nodes, std::span<const std::uint8_t> prescribed,
              const BlockMatrix& stiffness);
    Hierarchy(const Model& model, const BlockMatrix& stiffness)
        : Hierarchy(model.mesh.nodes, model.prescribed, stiffness) {}

    /// New values for the same mesh and prescribed dofs.
    void update(const BlockMatrix& stiffness);

    /// Frees all values but keeps the patterns: what is left to do once a device has them.
    /// `update` brings them back.
    void drop_values();

    std::span<const MultigridLevel> levels() const { return levels_; }
    /// Inverse of the coarsest matrix, symmetric, dense. Empty if level 0 has no free dof.
    const Eigen::MatrixXd& coarsest_inverse() const { return coarsest_inverse_; }

private:
    const BlockMatrix& matrix_of(std::size_t level, const BlockMatrix& stiffness) const {
        return level == 0 ? stiffness : levels_[level].matrix;
    }
    void compute_values(std::size_t level, const BlockMatrix& matrix);

    std::vector<unsigned char> held_;  ///< [num_dofs] of level 0: prescribed or without stiffness
    std::vector<MultigridLevel> levels_;
    Eigen::MatrixXd coarsest_inverse_;
};

/// Transposed pattern and values: restriction from a prolongation.
BlockMatrix transposed(const BlockMatrix& matrix);

}  // namespace palpate
