// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/multigrid/multigrid.hpp"

namespace palpate {
namespace {

constexpr double eigenvalue_safety = 1.1;  ///< a polynomial grows fast beyond its interval

/// The dense inverse of the coarsest matrix as one full pattern of b x b blocks.
BlockMatrix dense_blocks(const Eigen::MatrixXd& matrix, int b) {
    BlockMatrix result;
    const Index count = static_cast<Index>(matrix.rows()) / b;
    result.num_columns = count;
    result.block_rows = result.block_columns = b;
    for (Index row = 0; row <= count; ++row) result.graph.offsets.push_back(row * count);
    result.blocks.reserve(matrix.size());
    for (Index row = 0; row < count; ++row)
        for (Index column = 0; column < count; ++column) {
            result.graph.items.push_back(column);
            for (int i = 0; i < b; ++i)
                for (int j = 0; j < b; ++j)
                    result.blocks.push_back(matrix(b * row + i, b * column + j));
        }
    return result;
}

}  // namespace

Multigrid::Multigrid(Backend& backend, const DeviceOperator& matrix, const Hierarchy& hierarchy)
    : backend_(backend), matrix_(matrix) {
    const auto source = hierarchy.levels();
    levels_.resize(source.size());
    for (std::size_t l = 0; l + 1 < source.size(); ++l) {
        if (l > 0)
            levels_[l].matrix =
                backend_.make_operator(source[l].matrix, source[l].inverse_diagonal);
        levels_[l].prolongation = backend_.make_operator(source[l].prolongation, {});
        levels_[l].restriction = backend_.make_operator(transposed(source[l].prolongation), {});
    }
    coarsest_ = backend_.make_operator(
        dense_blocks(hierarchy.coarsest_inverse(), source.size() == 1 ? 3 : 6), {});
    for (std::size_t l = 0; l < levels_.size(); ++l)
        levels_[l].steps = smoothing_steps(source[l].largest_eigenvalue);
}

void Multigrid::update(const Hierarchy& hierarchy) {
    const auto source = hierarchy.levels();
    for (std::size_t l = 0; l + 1 < source.size(); ++l) {
        if (l > 0)
            backend_.set_values(*levels_[l].matrix, source[l].matrix, source[l].inverse_diagonal);
        backend_.set_values(*levels_[l].prolongation, source[l].prolongation, {});
        backend_.set_values(*levels_[l].restriction, transposed(source[l].prolongation), {});
        levels_[l].steps = smoothing_steps(source[l].largest_eigenvalue);
    }
    backend_.set_values(*coarsest_,
                        dense_blocks(hierarchy.coarsest_inverse(), source.size() == 1 ? 3 : 6), {});
}

/// Chebyshev iteration on [lambda / smoothed_share, lambda] (Saad 2003, algorithm 12.1), written as
/// a recurrence over two vectors: x_new = x + keep (x - x_old) + weight D^-1 (b - A x).
std::vector<Multigrid::Step> Multigrid::smoothing_steps(double largest_eigenvalue) {
    const double upper = eigenvalue_safety * largest_eigenvalue;
    const double lower = upper / smoothed_share;
    // theta = (b + a) / 2, delta = (b - a) / 2 on [a, b], sigma = theta / delta, rho_0 = 1 / sigma,
    // rho_k = 1 / (2 sigma - rho_(k-1)): x += rho_k rho_(k-1) (x - x_old) + 2 rho_k / delta D^-1 r.
    const double middle = 0.5 * (upper + lower), half_width = 0.5 * (upper - lower);
    const double sigma = middle / half_width;
    double rho = 1 / sigma;
    std::vector<Step> steps = {{1, 0, 1 / middle}};
    for (int degree = 2; degree <= smoothing_degree; ++degree) {
        const double rho_new = 1 / (2 * sigma - rho);
        const double keep = rho_new * rho;
        // As y = alpha x + beta x_old + weight D^-1 r (method.md, 11.5).
        steps.push_back({1 + keep, -keep, 2 * rho_new / half_width});
        rho = rho_new;
    }
    return steps;
}

std::vector<Multigrid::Vectors>& Multigrid::vectors_for(Index columns) {
    std::vector<Vectors>& vectors = vectors_[columns];
    if (vectors.empty()) {
        vectors.resize(levels_.size());
        for (std::size_t l = 0; l < levels_.size(); ++l) {
            const bool is_coarsest = l + 1 == levels_.size();
            const Index rows = is_coarsest ? coarsest_->rows() : matrix_of(l).rows();
            if (l > 0) vectors[l].b = backend_.make_vector(rows, columns);
            if (l > 0) vectors[l].x = backend_.make_vector(rows, columns);
            if (!is_coarsest) vectors[l].spare = backend_.make_vector(rows, columns);
        }
    }
    return vectors;
}

void Multigrid::keep_only(Index columns) {
    std::erase_if(vectors_, [&](const auto& entry) { return entry.first != columns; });
}

void Multigrid::apply(const DeviceVector& r, DeviceVector& z, DeviceSums& rz) {
    cycle(0, r, z, vectors_for(r.columns()), &rz);
}

void Multigrid::cycle(std::size_t level, const DeviceVector& b, DeviceVector& x,
                      std::vector<Vectors>& vectors, DeviceSums* bx) {
    if (level + 1 == levels_.size()) {
        // x = A^-1 b
        backend_.apply(*coarsest_, b, x);
        if (bx) backend_.dot(b, x, *bx);
        return;
    }
    const Level& here = levels_[level];
    const DeviceOperator& matrix = matrix_of(level);
    // Two vectors take turns: `now` holds the iterate, `other` the one before it. There are 2 n - 1
    // turns, so the last iterate lies in x.
    DeviceVector* now = vectors[level].spare.get();
    DeviceVector* other = &x;
    // From x = 0 the first step is x = weight D^-1 b.
    backend_.apply_inverse_diagonal(matrix, here.steps[0].weight, b, *now);
    for (std::size_t s = 1; s < here.steps.size(); ++s) {
        // The iterate before the first is zero.
        backend_.smooth(matrix, b, *now, here.steps[s].alpha, s == 1 ? 0.0 : here.steps[s].beta,
                        here.steps[s].weight, *other);
        std::swap(now, other);
    }

    // r = b - A x, b_coarse = P^T r, x += P x_coarse
    backend_.residual(matrix, b, *now, *other);
    Vectors& next = vectors[level + 1];
    backend_.apply(*here.restriction, *other, *next.b);
    cycle(level + 1, *next.b, *next.x, vectors, nullptr);
    backend_.apply_add(*here.prolongation, *next.x, *now);

    // The steps from before the coarse level again: M stays symmetric, as conjugate gradients ask.
    for (std::size_t s = 0; s < here.steps.size(); ++s) {
        backend_.smooth(matrix, b, *now, here.steps[s].alpha, here.steps[s].beta,
                        here.steps[s].weight, *other, s + 1 == here.steps.size() ? bx : nullptr);
        std::swap(now, other);
    }
}

}  // namespace palpate
