// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/mumps_factor.hpp"

#include <dmumps_c.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/linear/dissected_order.hpp"

namespace palpate {
namespace {

// Columns of one call, which hold memory, and of one pass over the factor in it. 1,600 columns at
// 17,500 unknowns on two threads of BLAS: passes of 64 take 2.3 s, of 128 1.6 s, of 256 1.7 s.
constexpr Index widest_block = 256;
constexpr int columns_per_pass = 128;
/// Right-hand sides with fewer entries than this part are handed over as sparse ones.
constexpr double sparse_part = 0.1;

// What the manual of MUMPS calls ICNTL and INFOG, with its numbers.
enum Control : int {
    error_stream = 1,
    diagnostic_stream = 2,
    global_stream = 3,
    print_level = 4,
    permutation = 6,
    ordering = 7,
    scaling = 8,
    root_parallelism = 13,
    more_memory_percent = 14,
    right_hand_side = 20,
    solve_blocking = 27,
};
enum Info : int { status = 1, status_detail = 2, num_negative_pivots = 12 };
enum Job : int { initialise = -1, finish = -2, analyse = 1, factorise = 2, solve = 3 };
constexpr int symmetric_definite = 1, given_order = 1, this_process = -987654;  // comm_fortran

std::mutex& one_call_at_a_time() {
    static std::mutex mutex;
    return mutex;
}

class MumpsFactor final : public SparseFactor {
public:
    MumpsFactor() {
        mumps_.par = 1;
        mumps_.sym = symmetric_definite;
        mumps_.comm_fortran = this_process;
        call(Job::initialise);
        for (int stream : {error_stream, diagnostic_stream, global_stream, print_level})
            control(stream) = 0;
        control(permutation) = 0;
        control(ordering) = given_order;
        control(scaling) = 0;  // so that pivots are those of the matrix itself
        control(root_parallelism) = 1;
        control(solve_blocking) = columns_per_pass;
    }
    ~MumpsFactor() override { call(Job::finish); }
    MumpsFactor(const MumpsFactor&) = delete;
    MumpsFactor& operator=(const MumpsFactor&) = delete;

    std::string library() const override { return "MUMPS " MUMPS_VERSION " with SCOTCH"; }

    void analyse(const Lower& matrix) override {
        const int n = static_cast<int>(matrix.rows());
        row_.resize(matrix.nonZeros());
        column_.resize(matrix.nonZeros());
        for (int j = 0; j < n; ++j)
            for (int k = matrix.outerIndexPtr()[j]; k < matrix.outerIndexPtr()[j + 1]; ++k) {
                row_[k] = matrix.innerIndexPtr()[k] + 1;
                column_[k] = j + 1;
            }
        position_.resize(n);
        std::iota(position_.begin(), position_.end(), 0);
        mumps_.n = n;
        mumps_.nnz = static_cast<MUMPS_INT8>(row_.size());
        mumps_.irn = row_.data();
        mumps_.jcn = column_.data();
        std::vector<int> order = dissected_order(matrix);
        for (int& place : order) ++place;
        mumps_.perm_in = order.data();
        call(Job::analyse);
        mumps_.perm_in = nullptr;
        require_success();
    }

    void factorise(const Lower& matrix) override {
        mumps_.a = const_cast<double*>(matrix.valuePtr());
        call(Job::factorise);
        // The estimate of the memory may be short; the manual says to ask for more of it.
        constexpr int most_memory_percent = 1000;
        while (needs_more_room() && control(more_memory_percent) < most_memory_percent) {
            control(more_memory_percent) *= 2;
            call(Job::factorise);
        }
        mumps_.a = nullptr;
        const int singular = -10;
        if (info(status) != singular) require_success();
        require_definite(info(status) == 0 && info(num_negative_pivots) == 0, smallest_pivot(),
                         largest_pivot());
    }

    const std::vector<int>& position() const override { return position_; }
    Index block_width(Index columns) const override { return std::clamp(columns, 1, widest_block); }
    bool brings_threads() const override { return true; }

    void solve(FactorBlock& x) const override {
        const std::size_t n = position_.size(), width = static_cast<std::size_t>(x.width());
        const std::size_t most_sparse = static_cast<std::size_t>(sparse_part * double(n * width));
        SparseColumns sparse = sparse_columns(x, n, most_sparse);
        if (sparse.is_whole && sparse.row.empty()) return;
        const auto dense = std::make_unique_for_overwrite<double[]>(n * width);  // [width, n]
        if (!sparse.is_whole)
            in_tiles(x, n, [&](std::size_t i, std::size_t c, double value) {
                dense[c * n + i] = value;
                return value;
            });
        solve_all(dense.get(), width, sparse.is_whole ? &sparse : nullptr);
        in_tiles(x, n, [&](std::size_t i, std::size_t c, double) { return dense[c * n + i]; });
    }

private:
    /// Compressed columns, counted from one.
    struct SparseColumns {
        std::vector<int> first, row;
        std::vector<double> value;
        bool is_whole = false;  ///< else there were more entries than wanted
    };

    static SparseColumns sparse_columns(FactorBlock& x, std::size_t n, std::size_t most_entries) {
        const std::size_t width = static_cast<std::size_t>(x.width());
        std::vector<std::vector<std::pair<int, double>>> columns(width);
        SparseColumns sparse;
        std::size_t entries = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double* row = x.row(static_cast<Index>(i));
            for (std::size_t c = 0; c < width; ++c)
                if (row[c] != 0) {
                    if (++entries > most_entries) return sparse;
                    columns[c].emplace_back(static_cast<int>(i) + 1, row[c]);
                }
        }
        sparse.is_whole = true;
        sparse.first.push_back(1);
        for (const auto& column : columns) {
            for (const auto& [row, value] : column) {
                sparse.row.push_back(row);
                sparse.value.push_back(value);
            }
            sparse.first.push_back(static_cast<int>(sparse.row.size()) + 1);
        }
        return sparse;
    }

    /// x(i, c) := change(i, c, x(i, c)) in an order that suits rows and columns, on all cores.
    template <typename Change>
    static void in_tiles(FactorBlock& x, std::size_t n, const Change& change) {
        constexpr std::size_t tile = 32;
        const std::size_t width = static_cast<std::size_t>(x.width());
        const Index num_tiles = static_cast<Index>((n + tile - 1) / tile);
        parallel_ranges(num_tiles, 16, [&](Index begin, Index end) {
            for (std::size_t i0 = begin * tile; i0 < std::min(n, end * tile); i0 += tile)
                for (std::size_t c0 = 0; c0 < width; c0 += tile)
                    for (std::size_t i = i0; i < std::min(n, i0 + tile); ++i) {
                        double* row = x.row(static_cast<Index>(i));
                        for (std::size_t c = c0; c < std::min(width, c0 + tile); ++c)
                            row[c] = change(i, c, row[c]);
                    }
        });
    }

    /// `dense`: [width, n], right-hand sides in (unless they are in `sparse`) and solutions out.
    void solve_all(double* dense, std::size_t width, SparseColumns* sparse) const {
        const std::lock_guard lock(one_call_at_a_time());
        mumps_.nrhs = static_cast<int>(width);
        mumps_.lrhs = mumps_.n;
        mumps_.rhs = dense;
        control(right_hand_side) = sparse ? 1 : 0;
        if (sparse) {
            mumps_.nz_rhs = static_cast<int>(sparse->row.size());
            mumps_.irhs_ptr = sparse->first.data();
            mumps_.irhs_sparse = sparse->row.data();
            mumps_.rhs_sparse = sparse->value.data();
        }
        mumps_.job = Job::solve;
        dmumps_c(&mumps_);
        require_success();
    }

    int& control(int number) const { return mumps_.icntl[number - 1]; }
    int info(int number) const { return mumps_.infog[number - 1]; }
    double smallest_pivot() const { return mumps_.rinfog[19 - 1]; }
    double largest_pivot() const { return mumps_.rinfog[21 - 1]; }
    bool needs_more_room() const {
        return info(status) == -8 || info(status) == -9 || info(status) == -20;
    }

    void call(int job) {
        const std::lock_guard lock(one_call_at_a_time());
        mumps_.job = job;
        dmumps_c(&mumps_);
    }

    void require_success() const {
        if (info(status) >= 0) return;
        for (int memory : {-5, -7, -8, -9, -13, -19, -20, -22})
            if (info(status) == memory)
                throw Error(ErrorCode::out_of_memory,
                            "The factor of the stiffness matrix does not fit into memory; use an "
                            "iterative solver (--linear-solver multigrid or jacobi) or a coarser "
                            "mesh.");
        throw Error(ErrorCode::solve_failed,
                    "The factorisation failed (MUMPS: INFOG(1) = " + std::to_string(info(status)) +
                        ", INFOG(2) = " + std::to_string(info(status_detail)) +
                        "); use an iterative solver (--linear-solver multigrid or jacobi).");
    }

    mutable DMUMPS_STRUC_C mumps_{};  ///< only touched while `one_call_at_a_time` is held
    std::vector<int> row_, column_;   ///< of the entries, counted from one
    std::vector<int> position_;       ///< MUMPS takes and gives rows in the order of the matrix
};

}  // namespace

bool has_mumps() { return true; }

std::unique_ptr<SparseFactor> make_mumps_factor() { return std::make_unique<MumpsFactor>(); }

}  // namespace palpate
