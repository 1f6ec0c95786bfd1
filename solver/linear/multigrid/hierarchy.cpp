// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/multigrid/hierarchy.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/linear/multigrid/block_kernels.hpp"

namespace palpate {
namespace {

constexpr Index coarse_rows_per_thread = 500;
constexpr int num_modes = 6;
constexpr int lanczos_steps = 8;
constexpr double eigenvalue_margin = 1.05;  ///< Ritz values of few steps come from below
constexpr double damping = 4.0 / 3.0;       ///< omega of the smoothed prolongation, over lambda_max
constexpr double smallest_mode = 1e-6;      ///< share of a mode that must survive orthogonalisation
constexpr double slowest_coarsening = 0.8;  ///< nodes of a level over nodes of the finer one

template <int B>
using Block = Eigen::Matrix<double, B, B, Eigen::RowMajor>;

/// Rigid translations and rotations about the middle of the mesh, lengths in units of its size.
Eigen::MatrixXd rigid_body_modes(std::span<const Vec3> nodes, std::span<const unsigned char> held) {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : nodes) centre += x;
    centre /= std::max<double>(1, nodes.size());
    double size = 0;
    for (const Vec3& x : nodes) size = std::max(size, (x - centre).norm());
    Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(3 * nodes.size(), num_modes);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Vec3 x = (nodes[n] - centre) / std::max(size, 1e-300);
        auto rows = modes.middleRows<3>(3 * n);
        // [1 | omega x] with omega along each axis: K maps these to zero where nothing is held.
        rows.leftCols<3>().setIdentity();
        rows.rightCols<3>() << 0, x[2], -x[1], -x[2], 0, x[0], x[1], -x[0], 0;
        for (int c = 0; c < 3; ++c)
            if (held[3 * n + c]) rows.row(c).setZero();
    }
    return modes;
}

/// D^-1 of the rows [first, last): held dofs and dofs without stiffness have the identity.
template <int B>
void invert_diagonal_of(const BlockMatrix& matrix, Index first, Index last,
                        std::span<const unsigned char> held, double* inverse) {
    for (Index n = first; n < last; ++n) {
        const auto begin = matrix.graph.items.begin() + matrix.graph.offsets[n];
        const auto end = matrix.graph.items.begin() + matrix.graph.offsets[n + 1];
        const Index k =
            static_cast<Index>(std::lower_bound(begin, end, n) - matrix.graph.items.begin());
        // K_nn without held dofs, whose rows and columns are those of the identity.
        Block<B> block = Eigen::Map<const Block<B>>(matrix.block(k));
        for (int i = 0; i < B; ++i)
            if ((!held.empty() && held[static_cast<std::size_t>(n) * B + i]) || block(i, i) <= 0) {
                block.row(i).setZero();
                block.col(i).setZero();
                block(i, i) = 1;
            }
        Block<B> result = block.inverse();
        // (A + A^T) / 2: the smoother stays symmetric in spite of rounding.
        result = (0.5 * (result + result.transpose())).eval();
        Eigen::Map<Block<B>>(inverse + static_cast<std::size_t>(n) * B * B) = result;
    }
}

/// Largest Ritz value of D^-1 A after a few steps of preconditioned conjugate gradients from a
/// fixed random start (the Lanczos process; Saad 2003, section 6.7.3).
double largest_eigenvalue(const BlockMatrix& matrix, std::span<const double> inverse_diagonal,
                          std::span<const unsigned char> held) {
    const int b = matrix.block_rows;
    const std::size_t size = static_cast<std::size_t>(matrix.num_rows()) * b;
    Eigen::VectorXd r(size), z(size), p, q(size);
    std::minstd_rand random(1);
    for (std::size_t i = 0; i < size; ++i)
        r[i] = held.empty() || !held[i] ? 2.0 * random() / random.max() - 1.0 : 0.0;
    const auto scale = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
        for (Index n = 0; n < matrix.num_rows(); ++n)
            out.segment(n * b, b).noalias() =
                Eigen::Map<
                    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
                    inverse_diagonal.data() + static_cast<std::size_t>(n) * b * b, b, b)
                    .lazyProduct(in.segment(n * b, b));
    };
    // With alpha_k, beta_k of conjugate gradients the Lanczos matrix is (Saad 2003, 6.7.3)
    //   T_kk = 1 / alpha_k + beta_k / alpha_(k-1),   T_k,k+1 = sqrt(beta_(k+1)) / alpha_k.
    std::vector<double> diagonal, side;
    scale(r, z);
    p = z;
    double rz = r.dot(z), alpha_before = 0, beta = 0;
    for (int step = 0; step < lanczos_steps && rz > 0; ++step) {
        parallel_ranges(matrix.num_rows(), coarse_rows_per_thread, [&](Index first, Index last) {
            // q = A p
            multiply_block_rows(matrix, first, last, p.data(), q.data());
        });
        if (!held.empty())
            for (std::size_t i = 0; i < size; ++i)
                if (held[i]) q[i] = 0;
        const double pq = p.dot(q);
        if (!(pq > 0)) break;
        // alpha = r.z / p.q, r -= alpha q, z = D^-1 r, beta = r.z / (r.z before), p = z + beta p
        const double alpha = rz / pq;
        diagonal.push_back(1 / alpha + (step > 0 ? beta / alpha_before : 0));
        r -= alpha * q;
        scale(r, z);
        const double rz_new = r.dot(z);
        beta = rz_new / rz;
        side.push_back(std::sqrt(std::max(beta, 0.0)) / alpha);
        alpha_before = alpha;
        rz = rz_new;
        p = z + beta * p;
    }
    if (diagonal.empty()) return 1;
    Eigen::MatrixXd tridiagonal = Eigen::MatrixXd::Zero(diagonal.size(), diagonal.size());
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
        tridiagonal(i, i) = diagonal[i];
        if (i + 1 < diagonal.size()) tridiagonal(i, i + 1) = tridiagonal(i + 1, i) = side[i];
    }
    return eigenvalue_margin *
           Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(tridiagonal, Eigen::EigenvaluesOnly)
               .eigenvalues()
               .maxCoeff();
}

/// Nodes of each aggregate.
Adjacency members_of(const Aggregates& aggregates) {
    Adjacency members;
    members.offsets.assign(aggregates.count + 1, 0);
    for (Index a : aggregates.of_node)
        if (a >= 0) ++members.offsets[a + 1];
    for (Index a = 0; a < aggregates.count; ++a) members.offsets[a + 1] += members.offsets[a];
    members.items.resize(members.offsets.back());
    std::vector<Index> next(members.offsets.begin(), members.offsets.end() - 1);
    for (Index n = 0; n < static_cast<Index>(aggregates.of_node.size()); ++n)
        if (aggregates.of_node[n] >= 0) members.items[next[aggregates.of_node[n]]++] = n;
    return members;
}

/// Orthonormal columns q with modes = q r; a mode that depends on those before it gives a zero
/// column and a zero row of r. Gram-Schmidt, each mode twice.
void orthonormalise(Eigen::MatrixXd& q, Eigen::Matrix<double, num_modes, num_modes>& r) {
    r.setZero();
    for (int j = 0; j < num_modes; ++j) {
        const double before = q.col(j).norm();
        for (int pass = 0; pass < 2; ++pass)
            for (int i = 0; i < j; ++i) {
                const double share = q.col(i).dot(q.col(j));
                r(i, j) += share;
                // r_ij = q_i . q_j, q_j -= r_ij q_i (modified Gram-Schmidt)
                q.col(j) -= share * q.col(i);
            }
        const double left = q.col(j).norm();
        if (left > smallest_mode * before && left > 0) {
            r(j, j) = left;
            q.col(j) /= left;
        } else {
            q.col(j).setZero();
        }
    }
}

/// The tentative prolongation [num_nodes, b, 6] and the modes of the next level.
std::vector<double> tentative_prolongation(const MultigridLevel& level, int b,
                                           Eigen::MatrixXd& coarse_modes) {
    const Adjacency members = members_of(level.aggregates);
    std::vector<double> tentative(level.aggregates.of_node.size() * b * num_modes, 0.0);
    coarse_modes.setZero(static_cast<Eigen::Index>(num_modes) * level.aggregates.count, num_modes);
    Eigen::MatrixXd q;
    Eigen::Matrix<double, num_modes, num_modes> r;
    for (Index a = 0; a < level.aggregates.count; ++a) {
        const Index first = members.offsets[a], count = members.offsets[a + 1] - first;
        q.resize(static_cast<Eigen::Index>(b) * count, num_modes);
        for (Index m = 0; m < count; ++m)
            // The modes of an aggregate are T_a = Q, with Q R = the modes at its nodes; R is what
            // the
            // coarse level has in their place, so that T R = modes there, too.
            q.middleRows(b * m, b) = level.modes.middleRows(b * members.items[first + m], b);
        orthonormalise(q, r);
        coarse_modes.middleRows<num_modes>(num_modes * a) = r;
        for (Index m = 0; m < count; ++m)
            Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
                &tentative[static_cast<std::size_t>(members.items[first + m]) * b * num_modes], b,
                num_modes) = q.middleRows(b * m, b);
    }
    return tentative;
}

/// For every row of `graph` the sorted union of the lists that `list_of` gives for its items; rows
/// for which `is_used` is false stay empty.
template <typename ListOf, typename IsUsed>
Adjacency union_of_lists(const Adjacency& graph, Index num_columns, IsUsed is_used,
                         ListOf list_of) {
    Adjacency result;
    result.offsets.reserve(graph.offsets.size());
    result.offsets.assign(1, 0);
    std::vector<Index> seen(num_columns, -1);
    for (Index row = 0; row < graph.num_lists(); ++row) {
        const std::size_t begin = result.items.size();
        if (is_used(row))
            for (Index k = graph.offsets[row]; k < graph.offsets[row + 1]; ++k)
                for (Index item : list_of(graph.items[k]))
                    if (seen[item] != row) {
                        seen[item] = row;
                        result.items.push_back(item);
                    }
        std::sort(result.items.begin() + static_cast<std::ptrdiff_t>(begin), result.items.end());
        result.offsets.push_back(static_cast<Index>(result.items.size()));
    }
    return result;
}

/// Aggregates that an edge joins. The coarse matrix reaches further, since smoothing widens the
/// prolongation: aggregating by its pattern would coarsen too fast.
Adjacency quotient_graph(const Adjacency& graph, const Aggregates& aggregates) {
    std::vector<Index> neighbours;
    const Adjacency members = members_of(aggregates);
    return union_of_lists(
        members, aggregates.count, [](Index) { return true; },
        [&](Index node) {
            neighbours.clear();
            for (Index k = graph.offsets[node]; k < graph.offsets[node + 1]; ++k)
                if (aggregates.of_node[graph.items[k]] >= 0)
                    neighbours.push_back(aggregates.of_node[graph.items[k]]);
            return std::span<const Index>(neighbours);
        });
}

std::span<const Index> list(const Adjacency& graph, Index row) {
    return {graph.items.data() + graph.offsets[row], graph.items.data() + graph.offsets[row + 1]};
}

void release(std::vector<double>& values) { std::vector<double>().swap(values); }

/// A pattern without values.
BlockMatrix empty_matrix(Adjacency graph, Index num_columns, int block_rows, int block_columns) {
    BlockMatrix matrix;
    matrix.graph = std::move(graph);
    matrix.num_columns = num_columns;
    matrix.block_rows = block_rows;
    matrix.block_columns = block_columns;
    return matrix;
}

/// Rows with a block in each block column, and the numbers of these blocks.
void transpose_pattern(const BlockMatrix& matrix, Adjacency& rows, std::vector<Index>& entries) {
    rows.offsets.assign(matrix.num_columns + 1, 0);
    for (Index column : matrix.graph.items) ++rows.offsets[column + 1];
    for (Index c = 0; c < matrix.num_columns; ++c) rows.offsets[c + 1] += rows.offsets[c];
    rows.items.resize(matrix.graph.items.size());
    entries.resize(rows.items.size());
    std::vector<Index> next(rows.offsets.begin(), rows.offsets.end() - 1);
    for (Index row = 0; row < matrix.num_rows(); ++row)
        for (Index k = matrix.graph.offsets[row]; k < matrix.graph.offsets[row + 1]; ++k) {
            const Index at = next[matrix.graph.items[k]]++;
            rows.items[at] = row;
            entries[at] = k;
        }
}

/// Patterns of P, A P and P^T A P below `level`, whose matrix has the pattern `graph`.
BlockMatrix lay_out_coarse_matrix(const Adjacency& graph, int b, MultigridLevel& level) {
    const Index count = level.aggregates.count;
    const std::vector<Index>& of_node = level.aggregates.of_node;
    const auto aggregate_of = [&](Index node) {
        return std::span<const Index>(&of_node[node], of_node[node] < 0 ? 0 : 1);
    };
    const auto has_aggregate = [&](Index node) { return of_node[node] >= 0; };
    // P = (1 - w D^-1 A) T reaches the aggregates of a node's neighbours (method.md, 11.3).
    level.prolongation = empty_matrix(union_of_lists(graph, count, has_aggregate, aggregate_of),
                                      count, b, num_modes);
    const Adjacency& p = level.prolongation.graph;
    // A P, then the coarse P^T A P (method.md, 11.4)
    level.product = empty_matrix(
        union_of_lists(graph, count, has_aggregate, [&](Index n) { return list(p, n); }), count, b,
        num_modes);
    transpose_pattern(level.prolongation, level.members, level.member_entries);
    const Adjacency& c = level.product.graph;
    return empty_matrix(
        union_of_lists(
            level.members, count, [](Index) { return true; }, [&](Index n) { return list(c, n); }),
        count, num_modes, num_modes);
}

/// Modes that an aggregate lacks (too few nodes) have zero rows: they stand still.
void hold_missing_modes(BlockMatrix& matrix) {
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k) {
            if (matrix.graph.items[k] != n) continue;
            double* block = matrix.block(k);
            for (int i = 0; i < num_modes; ++i)
                // Entry (i, i) of a 6 x 6 block is number 7 i.
                if (block[7 * i] <= 0) block[7 * i] = 1;
        }
}

Eigen::MatrixXd dense(const BlockMatrix& matrix) {
    const int b = matrix.block_rows;
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(matrix.num_rows() * b, matrix.num_rows() * b);
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
            result.block(n * b, matrix.graph.items[k] * b, b, b) = Eigen::Map<
                const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
                matrix.block(k), b, b);
    return result;
}

}  // namespace

Hierarchy::Hierarchy(std::span<const Vec3> nodes, std::span<const std::uint8_t> prescribed,
                     const BlockMatrix& stiffness) {
    held_.assign(prescribed.begin(), prescribed.end());
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (stiffness.graph.offsets[n + 1] - stiffness.graph.offsets[n] == 1)
            std::fill_n(held_.begin() + 3 * n, 3, std::uint8_t{1});
    levels_.emplace_back();
    levels_[0].modes = rigid_body_modes(nodes, held_);

    std::vector<unsigned char> takes_part(nodes.size());
    for (std::size_t n = 0; n < takes_part.size(); ++n)
        takes_part[n] = !(held_[3 * n] && held_[3 * n + 1] && held_[3 * n + 2]);
    Adjacency edges = stiffness.graph;
    for (std::size_t l = 0;; ++l) {
        const BlockMatrix& matrix = matrix_of(l, stiffness);
        const Index num_dofs = matrix.num_rows() * matrix.block_rows;
        if (num_dofs <= coarsest_dofs) break;
        levels_[l].aggregates = aggregate_nodes(edges, takes_part);
        const Index count = levels_[l].aggregates.count;
        if (count == 0 || count > slowest_coarsening * matrix.num_rows()) {
            levels_[l].aggregates = {};
            break;
        }
        BlockMatrix coarse = lay_out_coarse_matrix(matrix.graph, matrix.block_rows, levels_[l]);
        levels_.emplace_back();
        levels_[l + 1].matrix = std::move(coarse);
        compute_values(l, matrix_of(l, stiffness));
        takes_part.assign(count, 1);
        edges = quotient_graph(edges, levels_[l].aggregates);
    }
    compute_values(levels_.size() - 1, matrix_of(levels_.size() - 1, stiffness));
}

void Hierarchy::update(const BlockMatrix& stiffness) {
    for (std::size_t l = 0; l < levels_.size(); ++l) compute_values(l, matrix_of(l, stiffness));
}

void Hierarchy::drop_values() {
    for (MultigridLevel& level : levels_) {
        for (BlockMatrix* matrix : {&level.matrix, &level.prolongation}) release(matrix->blocks);
        release(level.inverse_diagonal);
    }
    coarsest_inverse_.resize(0, 0);
}

void Hierarchy::compute_values(std::size_t l, const BlockMatrix& matrix) {
    MultigridLevel& level = levels_[l];
    const int b = matrix.block_rows;
    const auto in_parallel = [](Index rows, auto&& work) {
        parallel_ranges(rows, coarse_rows_per_thread, work);
    };
    const std::span<const unsigned char> held =
        l == 0 ? std::span<const unsigned char>(held_) : std::span<const unsigned char>();
    level.inverse_diagonal.resize(static_cast<std::size_t>(matrix.num_rows()) * b * b);
    in_parallel(matrix.num_rows(), [&](Index first, Index last) {
        if (b == 3)
            invert_diagonal_of<3>(matrix, first, last, held, level.inverse_diagonal.data());
        else
            invert_diagonal_of<6>(matrix, first, last, held, level.inverse_diagonal.data());
    });
    if (l + 1 == levels_.size()) {
        Eigen::MatrixXd a = dense(matrix);
        for (std::size_t d = 0; d < held.size(); ++d)
            if (held[d]) {
                a.row(d).setZero();
                a.col(d).setZero();
                a(d, d) = 1;
            }
        // The coarsest level is solved with A^-1 = L^-T L^-1, dense.
        const Eigen::LLT<Eigen::MatrixXd> factor(a);
        if (factor.info() != Eigen::Success)
            throw Error(ErrorCode::solve_failed,
                        "The stiffness matrix is singular: a part of the mesh is free to move "
                        "rigidly; prescribe the displacement of at least three of its nodes.");
        coarsest_inverse_ = factor.solve(Eigen::MatrixXd::Identity(a.rows(), a.cols()));
        coarsest_inverse_ = (0.5 * (coarsest_inverse_ + coarsest_inverse_.transpose())).eval();
        return;
    }
    // lambda_max of D^-1 A: both w = 4/3 / lambda_max and the smoother need it.
    level.largest_eigenvalue = largest_eigenvalue(matrix, level.inverse_diagonal, held);

    BlockMatrix& coarse = levels_[l + 1].matrix;
    for (BlockMatrix* wanted : {&level.prolongation, &level.product, &coarse})
        wanted->blocks.resize(wanted->graph.items.size() * wanted->block_size());
    const std::vector<double> tentative = tentative_prolongation(level, b, levels_[l + 1].modes);
    in_parallel(matrix.num_rows(), [&](Index first, Index last) {
        // P = (1 - w D^-1 A) T (method.md, 11.3)
        smooth_prolongation(matrix, first, last, level.inverse_diagonal.data(),
                            damping / level.largest_eigenvalue, level.aggregates.of_node.data(),
                            tentative.data(), level.prolongation);
    });
    if (!held.empty()) {
        const BlockMatrix& p = level.prolongation;
        for (Index n = 0; n < p.num_rows(); ++n)
            for (int c = 0; c < 3; ++c)
                if (held[3 * n + c])
                    for (Index k = p.graph.offsets[n]; k < p.graph.offsets[n + 1]; ++k)
                        // Nothing is brought to dofs that do not move.
                        std::fill_n(level.prolongation.block(k) + num_modes * c, num_modes, 0.0);
    }
    in_parallel(matrix.num_rows(), [&](Index first, Index last) {
        // C = A P
        multiply_prolongation(matrix, level.prolongation, first, last, level.product);
    });
    in_parallel(coarse.num_rows(), [&](Index first, Index last) {
        // A_coarse = P^T C, one triangle of it (method.md, 11.4)
        multiply_restriction(level.prolongation, level.members, level.member_entries.data(),
                             level.product, first, last, coarse);
    });
    in_parallel(coarse.num_rows(),
                [&](Index first, Index last) { mirror_upper_triangle(coarse, first, last); });
    release(level.product.blocks);
    hold_missing_modes(coarse);
}

BlockMatrix transposed(const BlockMatrix& matrix) {
    Adjacency rows;
    std::vector<Index> entries;
    transpose_pattern(matrix, rows, entries);
    BlockMatrix result =
        empty_matrix(std::move(rows), matrix.num_rows(), matrix.block_columns, matrix.block_rows);
    result.blocks.resize(matrix.blocks.size());
    for (std::size_t k = 0; k < entries.size(); ++k) {
        const double* from = matrix.block(entries[k]);
        double* to = result.block(static_cast<Index>(k));
        for (int i = 0; i < matrix.block_rows; ++i)
            for (int j = 0; j < matrix.block_columns; ++j)
                to[matrix.block_rows * j + i] = from[matrix.block_columns * i + j];
    }
    return result;
}

}  // namespace palpate
