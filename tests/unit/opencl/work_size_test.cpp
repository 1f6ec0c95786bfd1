// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/work_size.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(ColumnPasses, CoverEveryColumnOnceInOrder) {
    for (bool is_cpu : {false, true})
        for (int max_width : {8, 16})
            for (std::size_t num_columns = 1; num_columns <= 70; ++num_columns) {
                std::size_t next = 0;
                for (const ColumnPass& pass : column_passes(num_columns, is_cpu, max_width)) {
                    EXPECT_EQ(pass.first, next);
                    EXPECT_GT(pass.groups, 0u);
                    EXPECT_LE(pass.width, max_width);
                    next += pass.groups * pass.width;
                }
                EXPECT_EQ(next, num_columns);
            }
}

TEST(WorkSize, IsRoundedUpToWholeGroups) {
    const WorkSize size{3, 65, {2, 64}};

    EXPECT_EQ(size.global_columns(), 4u);
    EXPECT_EQ(size.global_rows(), 128u);
}

}  // namespace
}  // namespace palpate
