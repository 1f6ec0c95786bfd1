// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// CHOLMOD's supernodal module is GPL: a program built with this file is under that licence.
#include <cholmod.h>

#include "bench/peers/peers.hpp"
#include "bench/process_memory.hpp"
#include "solver/base/error.hpp"

extern "C" char* openblas_get_config() __attribute__((weak));

namespace palpate::bench {
namespace {

/// Supernodal Cholesky factorisation with the ordering that CHOLMOD chooses by default: AMD, or
/// METIS where AMD fills up too much.
class Cholmod final : public Peer {
public:
    Cholmod() {
        cholmod_start(&common_);
        common_.supernodal = CHOLMOD_SUPERNODAL;
        common_.print = 0;
    }
    ~Cholmod() override {
        cholmod_free_dense(&y_, &common_);
        cholmod_free_dense(&e_, &common_);
        cholmod_free_factor(&factor_, &common_);
        cholmod_finish(&common_);
    }
    Cholmod(const Cholmod&) = delete;
    Cholmod& operator=(const Cholmod&) = delete;

    void set_up(const FreeMatrix& matrix) override {
        const std::size_t n = matrix.dofs.size();
        cholmod_sparse* lower = cholmod_allocate_sparse(n, n, matrix.values.size() / 2 + n, 1, 1,
                                                        -1, CHOLMOD_REAL, &common_);
        check("hold the matrix");
        copy_lower(matrix, *lower);
        factor_ = cholmod_analyze(lower, &common_);
        const bool fits = common_.status == CHOLMOD_OK && factor_fits();
        if (fits) cholmod_factorize(lower, factor_, &common_);
        cholmod_free_sparse(&lower, &common_);
        check("factorise");
        if (!fits)
            throw Error(ErrorCode::out_of_memory, "CHOLMOD's factor would take " +
                                                      std::to_string(int(factor_mib())) +
                                                      " MiB, more than the memory that is left.");
    }

    int solve(const Columns& b, Columns& x, double) override {
        const std::size_t n = static_cast<std::size_t>(b.rows());
        Eigen::MatrixXd rhs = b;  // CHOLMOD's dense matrices are column-major
        cholmod_dense dense{};
        dense.nrow = dense.d = n;
        dense.ncol = static_cast<std::size_t>(b.cols());
        dense.nzmax = n * dense.ncol;
        dense.x = rhs.data();
        dense.xtype = CHOLMOD_REAL;
        dense.dtype = CHOLMOD_DOUBLE;
        cholmod_dense* answer = nullptr;
        cholmod_solve2(CHOLMOD_A, factor_, &dense, nullptr, &answer, nullptr, &y_, &e_, &common_);
        check("solve");
        x = Eigen::Map<const Eigen::MatrixXd>(static_cast<double*>(answer->x), b.rows(), b.cols());
        cholmod_free_dense(&answer, &common_);
        return 0;
    }

    std::string describe() const override {
        const char* ordering =
            common_.selected >= 0 && common_.method[common_.selected].ordering == CHOLMOD_METIS
                ? "METIS"
                : "AMD";
        return "CHOLMOD " + std::to_string(CHOLMOD_MAIN_VERSION) + "." +
               std::to_string(CHOLMOD_SUB_VERSION) + "." + std::to_string(CHOLMOD_SUBSUB_VERSION) +
               " supernodal, " + ordering + ", BLAS " +
               (openblas_get_config ? openblas_get_config() : "unknown");
    }

private:
    /// The matrix is symmetric: its rows from the diagonal on are the columns of the lower
    /// triangle.
    static void copy_lower(const FreeMatrix& matrix, cholmod_sparse& lower) {
        int* offset = static_cast<int*>(lower.p);
        int* row = static_cast<int*>(lower.i);
        double* value = static_cast<double*>(lower.x);
        int used = 0;
        for (Index j = 0; j < matrix.num_rows(); ++j) {
            offset[j] = used;
            for (Index k = matrix.offsets[j]; k < matrix.offsets[j + 1]; ++k) {
                if (matrix.columns[k] < j) continue;
                row[used] = matrix.columns[k];
                value[used++] = matrix.values[k];
            }
        }
        offset[matrix.num_rows()] = used;
    }

    /// Of the supernodes and the largest update to one of them, known from the analysis.
    double factor_mib() const {
        return 8.0 * (double(factor_->xsize) + double(factor_->maxcsize)) / (1 << 20);
    }
    bool factor_fits() const {
        constexpr double share = 0.9;  // some is left to everything else
        const double available = available_memory_mib();
        return available == 0 || factor_mib() < share * available;
    }

    void check(const std::string& task) const {
        if (common_.status >= CHOLMOD_OK && common_.status != CHOLMOD_NOT_POSDEF) return;
        const bool too_large =
            common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE;
        throw Error(too_large ? ErrorCode::out_of_memory : ErrorCode::solve_failed,
                    "CHOLMOD could not " + task + " (status " + std::to_string(common_.status) +
                        (too_large ? ", out of memory)." : ")."));
    }

    cholmod_common common_;
    cholmod_factor* factor_ = nullptr;
    cholmod_dense *y_ = nullptr, *e_ = nullptr;  ///< work space, kept between solves
};

}  // namespace

std::vector<PeerEntry> cholmod_peers() {
    return {{"cholmod", [] { return std::make_unique<Cholmod>(); }}};
}

}  // namespace palpate::bench
