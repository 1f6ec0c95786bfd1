// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// PETSc's conjugate gradients with its usual preconditioners. PETSc shares work among processes,
// not threads: `mpirun -n 2 linear_solve_bench` gives it both cores. Further options of PETSc are
// read from the environment variable PETSC_OPTIONS.
#include <petscksp.h>

#include <algorithm>
#include <cstdlib>

#include "bench/peers/peers.hpp"
#include "solver/base/error.hpp"

namespace palpate::bench {
namespace {

static_assert(sizeof(PetscInt) == sizeof(Index), "the matrix is handed over without conversion");
static_assert(sizeof(PetscScalar) == sizeof(double));

void check(PetscErrorCode code) {
    if (code == 0) return;
    const char* text = nullptr;
    PetscErrorMessage(code, &text, nullptr);
    throw Error(code == PETSC_ERR_MEM ? ErrorCode::out_of_memory : ErrorCode::solve_failed,
                std::string("PETSc failed: ") + (text ? text : "unknown error") + ".");
}

/// PETSc lives from its first use to the end of the program.
class PetscProgram {
public:
    PetscProgram() {
        check(PetscInitializeNoArguments());
        check(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
    }
    ~PetscProgram() { PetscFinalize(); }
    static void start() { static const PetscProgram program; }
};

bool is_under_mpirun() { return std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMI_SIZE"); }

class PetscCg final : public Peer {
public:
    explicit PetscCg(PCType preconditioner) : preconditioner_(preconditioner) {
        PetscProgram::start();
    }
    ~PetscCg() override {
        KSPDestroy(&solver_);
        MatDestroy(&matrix_);
        VecDestroy(&b_);
        VecDestroy(&x_);
        VecDestroy(&whole_);
        VecScatterDestroy(&to_whole_);
    }
    PetscCg(const PetscCg&) = delete;
    PetscCg& operator=(const PetscCg&) = delete;

    void set_up(const FreeMatrix& matrix) override {
        make_matrix(matrix);
        check(MatCreateVecs(matrix_, &x_, &b_));
        if (std::string(preconditioner_) == PCGAMG) add_rigid_body_modes(matrix);
        check(VecScatterCreateToAll(x_, &to_whole_, &whole_));

        check(KSPCreate(PETSC_COMM_WORLD, &solver_));
        check(KSPSetType(solver_, KSPCG));
        check(KSPSetNormType(solver_, KSP_NORM_UNPRECONDITIONED));
        check(KSPSetOperators(solver_, matrix_, matrix_));
        PC pc;
        check(KSPGetPC(solver_, &pc));
        check(PCSetType(pc, preconditioner_));
        check(KSPSetFromOptions(solver_));
        check(KSPSetUp(solver_));
        check(KSPSetUpOnBlocks(solver_));
    }

    int solve(const Columns& b, Columns& x, double rtol) override {
        check(KSPSetTolerances(solver_, rtol, PETSC_DEFAULT, PETSC_DEFAULT, 20000));
        x.resize(b.rows(), b.cols());
        int iterations = 0;
        for (Index c = 0; c < b.cols(); ++c) {
            set_local_part(b.col(c));
            check(KSPSolve(solver_, b_, x_));
            PetscInt count = 0;
            KSPConvergedReason reason;
            check(KSPGetIterationNumber(solver_, &count));
            check(KSPGetConvergedReason(solver_, &reason));
            if (reason < 0)
                throw Error(ErrorCode::solve_failed, "PETSc's conjugate gradients stopped with " +
                                                         std::string(KSPConvergedReasons[reason]) +
                                                         ".");
            iterations += count;
            x.col(c) = whole_solution(b.rows());
        }
        return iterations;
    }

    std::string describe() const override {
        PetscMPIInt size = 1;
        MPI_Comm_size(PETSC_COMM_WORLD, &size);
        return "PETSc " + std::to_string(PETSC_VERSION_MAJOR) + "." +
               std::to_string(PETSC_VERSION_MINOR) + "." + std::to_string(PETSC_VERSION_SUBMINOR) +
               ", " + std::to_string(size) + (size == 1 ? " process" : " processes");
    }

private:
    /// Every process knows the whole matrix and keeps its share of the rows, whole nodes.
    void make_matrix(const FreeMatrix& matrix) {
        PetscMPIInt rank = 0, size = 1;
        check(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
        check(MPI_Comm_size(PETSC_COMM_WORLD, &size));
        const PetscInt num_nodes = matrix.num_rows() / 3;
        first_ = static_cast<PetscInt>(3 * (std::int64_t{num_nodes} * rank / size));
        last_ = static_cast<PetscInt>(3 * (std::int64_t{num_nodes} * (rank + 1) / size));
        const PetscInt rows = last_ - first_, first_entry = matrix.offsets[first_];
        std::vector<PetscInt> offsets(matrix.offsets.begin() + first_,
                                      matrix.offsets.begin() + last_ + 1);
        for (PetscInt& offset : offsets) offset -= first_entry;

        check(MatCreate(PETSC_COMM_WORLD, &matrix_));
        check(MatSetSizes(matrix_, rows, rows, matrix.num_rows(), matrix.num_rows()));
        check(MatSetType(matrix_, MATAIJ));
        check(MatSetBlockSize(matrix_, 3));
        check(MatSeqAIJSetPreallocationCSR(matrix_, offsets.data(),
                                           matrix.columns.data() + first_entry,
                                           matrix.values.data() + first_entry));
        check(MatMPIAIJSetPreallocationCSR(matrix_, offsets.data(),
                                           matrix.columns.data() + first_entry,
                                           matrix.values.data() + first_entry));
        check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
    }

    void add_rigid_body_modes(const FreeMatrix& matrix) {
        Vec coordinates;
        check(VecDuplicate(x_, &coordinates));
        check(VecSetBlockSize(coordinates, 3));
        PetscScalar* values = nullptr;
        check(VecGetArrayWrite(coordinates, &values));
        for (PetscInt d = first_; d < last_; ++d)
            values[d - first_] = matrix.coordinates[d / 3][d % 3];
        check(VecRestoreArrayWrite(coordinates, &values));
        MatNullSpace modes;
        check(MatNullSpaceCreateRigidBody(coordinates, &modes));
        check(MatSetNearNullSpace(matrix_, modes));
        check(MatNullSpaceDestroy(&modes));
        check(VecDestroy(&coordinates));
    }

    void set_local_part(const Eigen::VectorXd& column) {
        PetscScalar* values = nullptr;
        check(VecGetArrayWrite(b_, &values));
        std::copy(column.data() + first_, column.data() + last_, values);
        check(VecRestoreArrayWrite(b_, &values));
    }

    Eigen::VectorXd whole_solution(Eigen::Index rows) {
        check(VecScatterBegin(to_whole_, x_, whole_, INSERT_VALUES, SCATTER_FORWARD));
        check(VecScatterEnd(to_whole_, x_, whole_, INSERT_VALUES, SCATTER_FORWARD));
        const PetscScalar* values = nullptr;
        check(VecGetArrayRead(whole_, &values));
        const Eigen::VectorXd column = Eigen::Map<const Eigen::VectorXd>(values, rows);
        check(VecRestoreArrayRead(whole_, &values));
        return column;
    }

    PCType preconditioner_;
    Mat matrix_ = nullptr;
    Vec x_ = nullptr, b_ = nullptr, whole_ = nullptr;
    VecScatter to_whole_ = nullptr;
    KSP solver_ = nullptr;
    PetscInt first_ = 0, last_ = 0;  ///< rows of this process
};

}  // namespace

std::vector<PeerEntry> petsc_peers() {
    // pbjacobi inverts the 3x3 blocks of the nodes; bjacobi is PETSc's block Jacobi, ILU(0) of the
    // share of each process.
    std::vector<PeerEntry> entries;
    for (PCType type : {PCJACOBI, PCPBJACOBI, PCBJACOBI, PCGAMG})
        entries.push_back(
            {std::string("petsc_cg_") + type, [type] { return std::make_unique<PetscCg>(type); }});
    return entries;
}

ParallelRun petsc_parallel_run() {
    if (!is_under_mpirun()) return {};
    PetscProgram::start();
    ParallelRun run;
    MPI_Comm_rank(PETSC_COMM_WORLD, &run.rank);
    MPI_Comm_size(PETSC_COMM_WORLD, &run.size);
    return run;
}

}  // namespace palpate::bench
