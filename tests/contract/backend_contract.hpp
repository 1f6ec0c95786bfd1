// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solver/backends/reference/reference_backend.hpp"
#include "solver/linear/linear_solver.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

// One body for every back end in the registry, each precision and product, for several numbers of
// columns: what it computes must be what the reference back end computes element by element in
// fp64.
namespace palpate::backend_contract {

using fixtures::code_of;
using fixtures::random_columns;

struct Case {
    std::string backend;
    Precision precision;
    Product product;
};

/// One, a few, a full vector register's worth, one more than that, and twice as many.
inline const std::vector<Index> column_counts = {1, 3, 16, 17, 32};

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Sums of some 50 products of rounded numbers: a few tens of units in the last place.
inline double tolerance_of(Precision precision) {
    return precision == Precision::single ? 1e-5 : 1e-12;
}

/// 7 x 5 x 9 cubes: 1,440 rows and 1,890 tets, no multiple of any work group. One face held, one
/// node held along y only.
inline Model odd_model() {
    Model model = fixtures::two_tissue_model({7, 5, 9});
    model.prescribed[3 * (model.mesh.num_nodes() - 2) + 1] = 1;
    return model;
}

inline std::span<const double> as_span(const Columns& c) {
    return {c.data(), static_cast<std::size_t>(c.size())};
}

inline std::vector<double> random_numbers(std::size_t count, unsigned seed) {
    const Columns values = random_columns(static_cast<Index>(count), 1, seed);
    return {values.data(), values.data() + count};
}

/// Some five random blocks per row, every seventh row empty, row 10 full.
inline BlockMatrix random_matrix(Index rows, Index columns, int block_rows, int block_columns,
                                 unsigned seed) {
    BlockMatrix matrix;
    matrix.num_columns = columns;
    matrix.block_rows = block_rows;
    matrix.block_columns = block_columns;
    matrix.graph.offsets = {0};
    const Columns draw = random_columns(rows, columns, seed);
    for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < columns; ++j)
            if (i == 10 || (i % 7 != 3 && draw(i, j) < 10.0 / columns - 1))
                matrix.graph.items.push_back(j);
        matrix.graph.offsets.push_back(static_cast<Index>(matrix.graph.items.size()));
    }
    matrix.blocks = random_numbers(matrix.graph.items.size() * matrix.block_size(), seed + 1);
    return matrix;
}

/// One random block per row: `smooth` must use what it was given, whatever it is.
inline std::vector<double> random_diagonal(const BlockMatrix& matrix, unsigned seed) {
    return random_numbers(
        static_cast<std::size_t>(matrix.num_rows()) * matrix.block_rows * matrix.block_rows, seed);
}

inline std::unique_ptr<DeviceVector> to_device(Backend& backend, const Columns& values) {
    auto v =
        backend.make_vector(static_cast<Index>(values.rows()), static_cast<Index>(values.cols()));
    backend.copy_in(as_span(values), *v);
    return v;
}

inline std::unique_ptr<DeviceVector> nan_vector(Backend& backend, Index rows, Index columns) {
    auto v = backend.make_vector(rows, columns);
    backend.fill(*v, nan);
    return v;
}

inline Columns to_host(Backend& backend, const DeviceVector& v) {
    Columns values(v.rows(), v.columns());
    backend.copy_out(v, {values.data(), static_cast<std::size_t>(values.size())});
    return values;
}

inline std::unique_ptr<DeviceSums> sums_of(Backend& backend, const std::vector<double>& values) {
    auto sums = backend.make_sums(static_cast<Index>(values.size()));
    backend.set(*sums, values);
    return sums;
}

inline std::vector<double> numbers_of(Backend& backend, const DeviceSums& sums) {
    std::vector<double> values(sums.columns());
    backend.read(sums, values);
    return values;
}

class BackendContract : public testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        const Case& c = GetParam();
        auto [backend, reason] =
            fixtures::try_backend(c.backend, {c.precision, c.product, std::string()});
        if (!backend) GTEST_SKIP() << reason;
        backend_ = std::move(backend);
        oracle_ = make_reference_backend({Precision::double_, Product::matrix_free, ""});
    }

    void prepare(const Model& model) {
        model_ = model;
        backend_->prepare(model);
        oracle_->prepare(model);
    }

    Columns random_state(Index columns, unsigned seed) const {
        return random_columns(model_.num_dofs(), columns, seed);
    }

    /// `calls(backend, columns)` gives the same columns on both back ends.
    template <typename Calls>
    void expect_same(Calls calls, double scale = 1) {
        for (Index columns : column_counts)
            expect_close(calls(*backend_, columns), calls(*oracle_, columns), scale);
    }

    void expect_close(const Columns& actual, const Columns& expected, double scale = 1) {
        ASSERT_EQ(actual.cols(), expected.cols());
        for (Index c = 0; c < expected.cols(); ++c)
            EXPECT_LE((actual.col(c) - expected.col(c)).norm(),
                      scale * tolerance() * expected.col(c).norm())
                << "column " << c << " of " << expected.cols();
    }

    void expect_close(std::span<const double> actual, std::span<const double> expected) {
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(actual[i], expected[i], tolerance() * std::abs(expected[i])) << i;
    }

    void expect_sums(const DeviceSums& sums, const Columns& x, const Columns& y) {
        const std::vector<double> actual = numbers_of(*backend_, sums);
        for (Index c = 0; c < x.cols(); ++c)
            EXPECT_NEAR(actual[c], x.col(c).dot(y.col(c)),
                        tolerance() * x.col(c).norm() * y.col(c).norm())
                << "column " << c << " of " << x.cols();
    }

    /// The products of the stiffness or of another operator agree with the oracle's.
    void expect_same_products(const DeviceOperator& of_backend, const DeviceOperator& of_oracle,
                              unsigned seed) {
        const auto a = [&](Backend& backend) -> const DeviceOperator& {
            return &backend == backend_.get() ? of_backend : of_oracle;
        };
        expect_same([&](Backend& backend, Index columns) {
            const auto x = to_device(backend, random_columns(of_oracle.columns(), columns, seed));
            const auto y = nan_vector(backend, of_oracle.rows(), columns);
            backend.apply(a(backend), *x, *y);
            return to_host(backend, *y);
        });
        expect_same([&](Backend& backend, Index columns) {
            const auto x = to_device(backend, random_columns(of_oracle.columns(), columns, seed));
            const auto y = to_device(backend, random_columns(of_oracle.rows(), columns, seed + 1));
            backend.apply_add(a(backend), *x, *y);
            return to_host(backend, *y);
        });
        expect_same([&](Backend& backend, Index columns) {
            const auto x = to_device(backend, random_columns(of_oracle.columns(), columns, seed));
            const auto b = to_device(backend, random_columns(of_oracle.rows(), columns, seed + 2));
            const auto r = nan_vector(backend, of_oracle.rows(), columns);
            backend.residual(a(backend), *b, *x, *r);
            return to_host(backend, *r);
        });
    }

    /// So do the steps of a smoother, with and without the old content of y.
    void expect_same_smoothing(const DeviceOperator& of_backend, const DeviceOperator& of_oracle,
                               unsigned seed) {
        const Index rows = of_oracle.rows();
        const auto a = [&](Backend& backend) -> const DeviceOperator& {
            return &backend == backend_.get() ? of_backend : of_oracle;
        };
        expect_same([&](Backend& backend, Index columns) {
            const auto r = to_device(backend, random_columns(rows, columns, seed));
            const auto z = nan_vector(backend, rows, columns);
            backend.apply_inverse_diagonal(a(backend), 0.7, *r, *z);
            return to_host(backend, *z);
        });
        for (const double beta : {0.0, -0.3})
            expect_same([&](Backend& backend, Index columns) {
                const auto b = to_device(backend, random_columns(rows, columns, seed + 1));
                const auto x = to_device(backend, random_columns(rows, columns, seed + 2));
                const auto y = beta == 0
                                   ? nan_vector(backend, rows, columns)
                                   : to_device(backend, random_columns(rows, columns, seed + 3));
                backend.smooth(a(backend), *b, *x, 1.2, beta, 0.6, *y);
                return to_host(backend, *y);
            });
    }

    void expect_right_sums(const DeviceOperator& a, unsigned seed) {
        for (Index columns : column_counts) {
            const Columns x = random_columns(a.columns(), columns, seed);
            const Columns b = random_columns(a.rows(), columns, seed + 1);
            const auto device_x = to_device(*backend_, x);
            const auto device_b = to_device(*backend_, b);
            const auto y = nan_vector(*backend_, a.rows(), columns);
            const auto sums = backend_->make_sums(columns);

            backend_->apply(a, *device_x, *y, sums.get());
            expect_sums(*sums, x, to_host(*backend_, *y));
            backend_->apply_inverse_diagonal(a, 0.7, *device_x, *y, sums.get());
            expect_sums(*sums, x, to_host(*backend_, *y));
            backend_->smooth(a, *device_b, *device_x, 1.2, 0.5, 0.6, *y, sums.get());
            expect_sums(*sums, b, to_host(*backend_, *y));
        }
    }

    void expect_same_mechanics(unsigned seed) {
        expect_same_products(backend_->stiffness(), oracle_->stiffness(), seed);
        expect_same_smoothing(backend_->stiffness(), oracle_->stiffness(), seed + 10);
        expect_same([&](Backend& backend, Index columns) {
            const auto x = to_device(backend, random_state(columns, seed + 20));
            const auto y = nan_vector(backend, model_.num_dofs(), columns);
            backend.internal_force(*x, *y);
            return to_host(backend, *y);
        });
    }

    double tolerance() const { return tolerance_of(GetParam().precision); }

    Model model_;
    std::unique_ptr<Backend> backend_;
    std::unique_ptr<Backend> oracle_;
};

}  // namespace palpate::backend_contract
