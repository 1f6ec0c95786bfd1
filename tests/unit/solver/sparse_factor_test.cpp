// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/sparse_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "solver/base/parallel.hpp"
#include "solver/linear/factor_libraries.hpp"
#include "solver/linear/supernodal_solve.hpp"
#include "tests/fixtures/columns.hpp"

namespace palpate {
namespace {

using fixtures::code_of;
using fixtures::random_columns;

constexpr double rounding = 1e-12;  ///< of well-conditioned systems of a few hundred unknowns

/// -u'' on a line of `n` points plus `shift` and a few far couplings: fill, but any order works.
Eigen::MatrixXd line_matrix(Index n, double shift) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    for (Index i = 0; i < n; ++i) matrix(i, i) = 2 + shift;
    for (Index i = 0; i + 1 < n; ++i) matrix(i, i + 1) = matrix(i + 1, i) = -1;
    for (Index i = 0; i + 17 < n; i += 5) {
        matrix(i, i + 17) = matrix(i + 17, i) = -0.5;
        matrix(i, i) += 0.5;
        matrix(i + 17, i + 17) += 0.5;
    }
    return matrix;
}

SparseFactor::Lower lower_of(const Eigen::MatrixXd& matrix) {
    SparseFactor::Lower lower = Eigen::MatrixXd(matrix.triangularView<Eigen::Lower>()).sparseView();
    lower.makeCompressed();
    return lower;
}

Columns solve(const SparseFactor& factor, const Columns& b) {
    FactorBlock block(static_cast<Index>(b.rows()),
                      factor.block_width(static_cast<Index>(b.cols())));
    for (Index i = 0; i < b.rows(); ++i)
        std::copy_n(b.row(i).data(), b.cols(), block.row(factor.position()[i]));
    factor.solve(block);
    Columns x(b.rows(), b.cols());
    for (Index i = 0; i < b.rows(); ++i)
        std::copy_n(block.row(factor.position()[i]), b.cols(), x.row(i).data());
    return x;
}

class SparseFactorTest : public testing::TestWithParam<std::string> {
protected:
    std::unique_ptr<SparseFactor> factor_ = make_sparse_factor(GetParam());
};

TEST_P(SparseFactorTest, SolvesOneAndManyColumns) {
    for (Index n : {1, 2, 61, 300}) {
        const Eigen::MatrixXd matrix = line_matrix(n, 0.1);
        const auto factor = make_sparse_factor(GetParam());
        factor->analyse(lower_of(matrix));
        factor->factorise(lower_of(matrix));

        for (Index columns : {1, 2, 5, 16}) {
            const Columns b = random_columns(n, columns, columns);

            EXPECT_LT((matrix * solve(*factor, b) - b).norm(), rounding * b.norm());
        }
    }
}

TEST_P(SparseFactorTest, SolvesColumnsOfOneEntry) {
    const Eigen::MatrixXd matrix = line_matrix(200, 0.1);
    factor_->analyse(lower_of(matrix));
    factor_->factorise(lower_of(matrix));
    Columns b = Columns::Zero(200, 3);
    b(0, 0) = b(199, 1) = b(77, 2) = 1;

    EXPECT_LT((matrix * solve(*factor_, b) - b).norm(), rounding);
}

TEST_P(SparseFactorTest, TakesNewValuesForTheSamePattern) {
    factor_->analyse(lower_of(line_matrix(200, 0.1)));
    factor_->factorise(lower_of(line_matrix(200, 0.1)));
    const Eigen::MatrixXd matrix = line_matrix(200, 3);
    const Columns b = random_columns(200, 4, 1);

    factor_->factorise(lower_of(matrix));

    EXPECT_LT((matrix * solve(*factor_, b) - b).norm(), rounding * b.norm());
}

TEST_P(SparseFactorTest, GivesEveryThreadTheSameAnswer) {
    const Eigen::MatrixXd matrix = line_matrix(300, 0.1);
    factor_->analyse(lower_of(matrix));
    factor_->factorise(lower_of(matrix));
    const Columns b = random_columns(300, 16, 1);
    const Columns alone = solve(*factor_, b);
    std::vector<Columns> together(8);

    parallel_ranges(8, 1, [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) together[i] = solve(*factor_, b);
    });

    for (const Columns& x : together) EXPECT_EQ(x, alone);
}

TEST_P(SparseFactorTest, RefusesAMatrixThatIsNotDefinite) {
    for (double shift : {-0.5, 0.0}) {
        Eigen::MatrixXd matrix = line_matrix(100, shift);
        matrix(0, 0) -= 1;  // with shift 0 constants cost nothing: singular, not indefinite
        matrix(99, 99) -= 1;
        factor_->analyse(lower_of(matrix));

        EXPECT_EQ(code_of([&] { factor_->factorise(lower_of(matrix)); }), ErrorCode::solve_failed);
    }
}

INSTANTIATE_TEST_SUITE_P(EveryLibrary, SparseFactorTest, testing::ValuesIn(sparse_factor_names()),
                         [](const auto& entry) { return entry.param; });

TEST(MakeSparseFactor, TakesTheFirstLibraryUnlessTold) {
    EXPECT_EQ(make_sparse_factor("")->library(),
              make_sparse_factor(sparse_factor_names().front())->library());
}

TEST(MakeSparseFactor, NamesTheLibrariesThatThereAre) {
    try {
        make_sparse_factor("pardiso");
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        for (const std::string& name : sparse_factor_names())
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << name;
    }
}

TEST(SolveSupernodal, FollowsTheFactorByHand) {
    // L = [2 . .; 1 3 .; 0 4 5] as one supernode of the columns 0 and 1 and one of column 2; the
    // entry above the diagonal must not be read.
    const int first_column[] = {0, 2, 3}, first_row[] = {0, 3, 4}, first_value[] = {0, 6, 7};
    const int row[] = {0, 1, 2, 2};
    const double value[] = {2, 1, 0, 1e300, 3, 4, 5};
    Eigen::Matrix3d lower;
    lower << 2, 0, 0, 1, 3, 0, 0, 4, 5;
    const SupernodalFactor factor{2, first_column, first_row, first_value, row, value};

    for (Index width : {1, 2, 9}) {
        const Columns b = random_columns(3, width, 1);
        Columns x = b;

        solve_supernodal(factor, width, x.data());

        EXPECT_LT((lower * lower.transpose() * x - b).norm(), rounding * b.norm());
    }
}

}  // namespace
}  // namespace palpate
