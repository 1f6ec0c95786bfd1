// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/base/serial_blas.hpp"

#include <gtest/gtest.h>

#include "solver/linear/direct.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

class SerialBlasTest : public testing::Test {
protected:
    void SetUp() override {
        if (!openblas_get_num_threads) GTEST_SKIP() << "this BLAS is not OpenBLAS";
        before_ = openblas_get_num_threads();
        openblas_set_num_threads(2);
    }
    void TearDown() override {
        if (openblas_get_num_threads) openblas_set_num_threads(before_);
    }

    int before_ = 1;
};

TEST_F(SerialBlasTest, HoldsUntilTheLastHolderIsGone) {
    {
        const SerialBlas first;
        {
            const SerialBlas second;
            EXPECT_EQ(openblas_get_num_threads(), 1);
        }
        EXPECT_EQ(openblas_get_num_threads(), 1);
    }
    EXPECT_EQ(openblas_get_num_threads(), 2);
}

TEST_F(SerialBlasTest, IsGoneAfterADirectSolve) {
    const Model model = fixtures::two_tissue_model({4, 4, 4});
    Columns x;

    make_direct_solver(model, {})->solve(fixtures::random_columns(model.num_dofs(), 40, 1), x);

    EXPECT_EQ(openblas_get_num_threads(), 2);
}

}  // namespace
}  // namespace palpate
