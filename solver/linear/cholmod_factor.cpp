// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/cholmod_factor.hpp"

#include <cholmod.h>

#include <algorithm>
#include <limits>

#include "solver/base/error.hpp"
#include "solver/linear/supernodal_solve.hpp"

#if defined(__GNUC__) && defined(__ELF__)
// CHOLMOD as Debian builds it runs small loops on OpenMP threads; null where none is linked.
extern "C" __attribute__((weak)) void omp_set_max_active_levels(int);
#define PALPATE_MAY_HAVE_OPENMP
#endif

namespace palpate {
namespace {

/// No OpenMP threads for the calling thread: beside those of BLAS, and of other factorisations at
/// the same time, they only wait for a core, spinning.
void stay_on_this_thread() {
#ifdef PALPATE_MAY_HAVE_OPENMP
    if (omp_set_max_active_levels) omp_set_max_active_levels(0);
#endif
}

/// Columns that share one pass over the factor. At 16,500 unknowns one column takes 8 ms, each of
/// 16 1.7 ms, of 32 1.3 ms, of 64 1.0 ms, of 128 0.8 ms, while the block grows out of the cache.
constexpr Index widest_block = 64;

/// CHOLMOD's view of the lower triangle; nothing is copied.
cholmod_sparse view_of(const SparseFactor::Lower& matrix) {
    cholmod_sparse view{};
    view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
    view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
    view.p = const_cast<int*>(matrix.outerIndexPtr());
    view.i = const_cast<int*>(matrix.innerIndexPtr());
    view.x = const_cast<double*>(matrix.valuePtr());
    view.stype = -1;  // symmetric, lower triangle stored
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = view.packed = 1;
    return view;
}

class CholmodFactor final : public SparseFactor {
public:
    CholmodFactor() {
        cholmod_start(&common_);
        common_.print = 0;  // failures are told by exceptions
        common_.supernodal = CHOLMOD_SUPERNODAL;
    }
    ~CholmodFactor() override {
        cholmod_free_factor(&factor_, &common_);
        cholmod_finish(&common_);
    }
    CholmodFactor(const CholmodFactor&) = delete;
    CholmodFactor& operator=(const CholmodFactor&) = delete;

    std::string library() const override {
        int version[3] = {};
        cholmod_version(version);
        return "CHOLMOD " + std::to_string(version[0]) + "." + std::to_string(version[1]) + "." +
               std::to_string(version[2]) + " supernodal";
    }

    void analyse(const Lower& matrix) override {
        cholmod_sparse view = view_of(matrix);
        cholmod_free_factor(&factor_, &common_);
        stay_on_this_thread();
        factor_ = cholmod_analyze(&view, &common_);
        require_memory();
        const int* unknown_at = static_cast<const int*>(factor_->Perm);
        position_.resize(factor_->n);
        for (std::size_t row = 0; row < factor_->n; ++row)
            position_[unknown_at[row]] = static_cast<int>(row);
    }

    void factorise(const Lower& matrix) override {
        stay_on_this_thread();
        cholmod_sparse view = view_of(matrix);
        cholmod_factorize(&view, factor_, &common_);
        require_memory();
        const bool finished = common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
        const auto [smallest, largest] = finished ? pivots() : std::pair{0.0, 0.0};
        require_definite(finished, smallest, largest);
    }

    const std::vector<int>& position() const override { return position_; }

    Index block_width(Index columns) const override { return std::clamp(columns, 1, widest_block); }

    void solve(FactorBlock& x) const override { solve_supernodal(blocks(), x.width(), x.data()); }

private:
    void require_memory() const {
        if (common_.status != CHOLMOD_OUT_OF_MEMORY && common_.status != CHOLMOD_TOO_LARGE) return;
        throw Error(ErrorCode::out_of_memory,
                    "The factor of the stiffness matrix does not fit into memory; use an iterative "
                    "solver (--linear-solver multigrid or jacobi) or a coarser mesh.");
    }

    SupernodalFactor blocks() const {
        return {static_cast<Index>(factor_->nsuper),  static_cast<const int*>(factor_->super),
                static_cast<const int*>(factor_->pi), static_cast<const int*>(factor_->px),
                static_cast<const int*>(factor_->s),  static_cast<const double*>(factor_->x)};
    }

    /// Smallest and largest L_jj^2: what the D of an L D L^T would hold.
    std::pair<double, double> pivots() const {
        const SupernodalFactor l = blocks();
        double smallest = std::numeric_limits<double>::infinity(), largest = 0;
        for (Index s = 0; s < l.num_blocks; ++s) {
            const std::ptrdiff_t rows = l.first_row[s + 1] - l.first_row[s];
            for (int j = 0; j < l.first_column[s + 1] - l.first_column[s]; ++j) {
                const double diagonal = l.value[l.first_value[s] + j * (rows + 1)];
                smallest = std::min(smallest, diagonal * diagonal);
                largest = std::max(largest, diagonal * diagonal);
            }
        }
        return {smallest, largest};
    }

    cholmod_common common_;
    cholmod_factor* factor_ = nullptr;
    std::vector<int> position_;
};

}  // namespace

bool has_cholmod() { return true; }

std::unique_ptr<SparseFactor> make_cholmod_factor() { return std::make_unique<CholmodFactor>(); }

}  // namespace palpate

#undef PALPATE_MAY_HAVE_OPENMP
