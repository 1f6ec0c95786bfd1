// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/kokkos/kokkos_backend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "solver/backends/kokkos/column_sweep.hpp"
#include "solver/backends/reference/reference_backend.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

// What the contract of all back ends does not say about this one.
namespace palpate {
namespace {

using fixtures::code_of;

TEST(KokkosBackend, HasOneDeviceAndTakesNoOther) {
    const std::vector<DeviceInfo> devices = kokkos_devices();
    ASSERT_EQ(devices.size(), 1u);

    const auto backend = make_kokkos_backend({Precision::single, {}, devices.front().id});

    EXPECT_EQ(backend->describe().device, devices.front().id);
    EXPECT_EQ(code_of([] {
                  make_kokkos_backend({Precision::single, {}, "abacus"});
              }),
              ErrorCode::device_unavailable);
}

TEST(KokkosBackend, RefusesVectorsOfAnotherBackEndOrPrecision) {
    const auto backend = make_kokkos_backend({Precision::single, {}, ""});
    const auto of_double = make_kokkos_backend({Precision::double_, {}, ""})->make_vector(3, 1);
    const auto of_reference = make_reference_backend({})->make_vector(3, 1);

    EXPECT_EQ(code_of([&] { backend->fill(*of_double, 0); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { backend->fill(*of_reference, 0); }), ErrorCode::invalid_argument);
}

TEST(KokkosBackend, RefusesTheStiffnessOfAnotherBackEnd) {
    const auto backend = make_kokkos_backend({Precision::double_, {}, ""});
    const auto other = make_kokkos_backend({Precision::double_, {}, ""});
    const Model model = fixtures::two_tissue_model({2, 2, 2});
    backend->prepare(model);
    other->prepare(model);
    const auto x = backend->make_vector(model.num_dofs(), 1);
    const auto y = backend->make_vector(model.num_dofs(), 1);

    EXPECT_EQ(code_of([&] { backend->apply(other->stiffness(), *x, *y); }),
              ErrorCode::invalid_argument);
}

TEST(KokkosBackend, RefusesAMatrixThatPointsOutsideItself) {
    const auto backend = make_kokkos_backend({Precision::double_, {}, ""});
    BlockMatrix matrix;
    matrix.num_columns = 2;
    matrix.graph.offsets = {0, 1};
    matrix.graph.items = {2};
    matrix.blocks.assign(9, 1.0);

    EXPECT_EQ(code_of([&] { backend->make_operator(matrix, {}); }), ErrorCode::invalid_argument);
}

TEST(KokkosBackend, SaysThatMemoryRanOut) {
#ifdef PALPATE_ADDRESS_SANITIZER
    GTEST_SKIP() << "The address sanitizer ends a program that asks for this much.";
#endif
    const auto backend = make_kokkos_backend({Precision::double_, {}, ""});

    EXPECT_EQ(code_of([&] { backend->make_vector(std::numeric_limits<Index>::max(), 1 << 20); }),
              ErrorCode::out_of_memory);
}

TEST(KokkosBackend, FillsFreshVectorsWithNanInDebugBuilds) {
#ifdef NDEBUG
    GTEST_SKIP() << "This is not a debug build.";
#endif
    const auto backend = make_kokkos_backend({Precision::double_, {}, ""});
    std::vector<double> values(15);

    backend->copy_out(*backend->make_vector(5, 3), values);

    for (double value : values) EXPECT_TRUE(std::isnan(value));
}

/// Adds up row numbers, which are exact: every item must be counted once.
struct CountItems {
    static constexpr Index part_length = 3;

    const double* numbers;

    template <int width>
    KOKKOS_INLINE_FUNCTION void run(Index first, Index last, Index,
                                    Lanes<double, width>& sums) const {
        Lanes<double, width> row;
        for (Index item = first; item < last; ++item) {
            row.load(numbers + item);
            sums.add(row);
        }
    }
};

TEST(ColumnSweep, SumsEveryItemOnceThroughAllLevels) {
    constexpr Index columns = 17;  // column c adds up item + (c mod width), whatever the width
    for (Index items : {0, 1, 3, 4, 767, 768, 769, 3 * 256 * 256 + 5}) {
        const KokkosLease lease;
        SumBuffers buffers;
        KokkosSums sums(columns);
        std::vector<double> numbers(items + 32);
        std::iota(numbers.begin(), numbers.end(), 1.0);
        const Array<double> on_device = array_of(numbers);

        sweep<double>(CountItems{on_device.data()}, items, columns, buffers, &sums);

        std::vector<double> actual(columns);
        read_array(sums.values, actual);
        EXPECT_EQ(actual.front(), 0.5 * items * (items + 1.0)) << items;
        EXPECT_EQ(actual.back(), 0.5 * items * (items + 1.0)) << items;
    }
}

}  // namespace
}  // namespace palpate
