// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "tests/contract/backend_contract.hpp"

// Vectors, sums, and the steps of conjugate gradients on them.
namespace palpate::backend_contract {
namespace {

TEST_P(BackendContract, BringsValuesThereAndBack) {
    for (Index columns : column_counts) {
        const Columns values = random_columns(1237, columns, 1);

        const Columns back = to_host(*backend_, *to_device(*backend_, values));

        EXPECT_LT((back - values).cwiseAbs().maxCoeff(), 1e-7);
    }
}

TEST_P(BackendContract, FillsEveryValue) {
    for (Index columns : column_counts) {
        const auto v = to_device(*backend_, random_columns(1237, columns, 2));

        backend_->fill(*v, -2.5);

        EXPECT_TRUE((to_host(*backend_, *v).array() == -2.5).all());
    }
}

TEST_P(BackendContract, CopiesChosenColumnsAndLeavesTheOthers) {
    const Columns from = random_columns(1237, 5, 3), to = random_columns(1237, 17, 4);
    const std::vector<Index> from_columns = {4, 0, 3}, to_columns = {1, 16, 0};
    const auto device_from = to_device(*backend_, from);
    const auto device_to = to_device(*backend_, to);

    backend_->copy_columns(*device_from, from_columns, *device_to, to_columns);

    Columns expected = to;
    for (std::size_t i = 0; i < from_columns.size(); ++i)
        expected.col(to_columns[i]) = from.col(from_columns[i]);
    EXPECT_LT((to_host(*backend_, *device_to) - expected).cwiseAbs().maxCoeff(), 1e-7);
}

TEST_P(BackendContract, PermutesColumns) {
    for (Index columns : column_counts) {
        const Columns from = random_columns(301, columns, 5);
        std::vector<Index> identity(columns), reversed(columns);
        for (Index c = 0; c < columns; ++c) identity[c] = c, reversed[c] = columns - 1 - c;
        const auto to = nan_vector(*backend_, 301, columns);

        backend_->copy_columns(*to_device(*backend_, from), identity, *to, reversed);

        const Columns expected = from.rowwise().reverse();
        EXPECT_LT((to_host(*backend_, *to) - expected).cwiseAbs().maxCoeff(), 1e-7);
    }
}

TEST_P(BackendContract, CopiesNoColumnAtAll) {
    const Columns values = random_columns(301, 3, 6);
    const auto v = to_device(*backend_, values);

    backend_->copy_columns(*backend_->make_vector(301, 2), {}, *v, {});

    EXPECT_LT((to_host(*backend_, *v) - values).cwiseAbs().maxCoeff(), 1e-7);
}

TEST_P(BackendContract, ExchangesColumnsWithTheOtherPrecision) {
    const Precision other_precision =
        GetParam().precision == Precision::single ? Precision::double_ : Precision::single;
    const auto [other, reason] = fixtures::try_backend(
        GetParam().backend, {other_precision, GetParam().product, std::string()});
    if (!other) GTEST_SKIP() << reason;
    const Columns values = random_columns(1237, 3, 10);
    const std::vector<Index> there = {2, 0, 1}, back = {0, 1, 2};
    const auto here = to_device(*backend_, values);
    const auto elsewhere = nan_vector(*other, 1237, 4);
    const auto returned = nan_vector(*backend_, 1237, 3);

    other->copy_columns(*here, back, *elsewhere, there);
    backend_->copy_columns(*elsewhere, there, *returned, back);

    EXPECT_LT((to_host(*backend_, *returned) - values).cwiseAbs().maxCoeff(), 1e-7);
    const Columns middle = to_host(*other, *elsewhere);
    EXPECT_LT((middle.col(2) - values.col(0)).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_TRUE(middle.col(3).array().isNaN().all());
}

TEST_P(BackendContract, KeepsOneNumberPerColumn) {
    for (Index columns : column_counts) {
        const std::vector<double> values = random_numbers(columns, 11);

        expect_close(numbers_of(*backend_, *sums_of(*backend_, values)), values);
    }
}

TEST_P(BackendContract, SumsProductsPerColumn) {
    for (Index columns : column_counts) {
        const Columns x = random_columns(2999, columns, 12), y = random_columns(2999, columns, 13);
        const auto sums = backend_->make_sums(columns);

        backend_->dot(*to_device(*backend_, x), *to_device(*backend_, y), *sums);

        expect_sums(*sums, x, y);
    }
}

TEST_P(BackendContract, SumsOfNothingAreZero) {
    const auto nothing = backend_->make_vector(0, 3);
    const auto sums = sums_of(*backend_, {1, 2, 3});
    backend_->fill(*nothing, 1.0);

    backend_->dot(*nothing, *nothing, *sums);

    EXPECT_EQ(numbers_of(*backend_, *sums), std::vector<double>(3, 0.0));
}

/// Columns take turns to move, to be done (rr = limit), and to have no positive pq.
struct StepNumbers {
    std::vector<double> rz, pq, rr, limit;

    StepNumbers(Index columns, Index shift) {
        for (Index c = 0; c < columns; ++c) {
            const Index kind = (c + shift) % 4;
            rz.push_back(kind == 3 ? 0.0 : 0.5 + c);
            pq.push_back(kind == 2 ? -1.0 : kind == 3 ? 0.0 : 2.0 + 0.1 * c);
            rr.push_back(1e-3 * (c + 1));
            limit.push_back(kind == 1 ? rr.back() : 0.5 * rr.back());
        }
    }
};

TEST_P(BackendContract, AdvancesAlongTheSearchDirections) {
    for (Index shift : {0, 1, 2, 3}) {
        for (bool of_residual : {false, true}) {
            expect_same([&](Backend& backend, Index columns) {
                const StepNumbers step(columns, shift);
                const auto p = to_device(backend, random_columns(1237, columns, 14));
                const auto q = to_device(backend, random_columns(1237, columns, 15));
                const auto x = to_device(backend, random_columns(1237, columns, 16));
                const auto r = to_device(backend, random_columns(1237, columns, 17));
                const auto rr_new = backend.make_sums(columns);

                backend.advance(*sums_of(backend, step.rz), *sums_of(backend, step.pq),
                                *sums_of(backend, step.rr), *sums_of(backend, step.limit), *p, *q,
                                *x, *r, *rr_new);

                if (&backend == backend_.get())
                    expect_sums(*rr_new, to_host(backend, *r), to_host(backend, *r));
                return to_host(backend, of_residual ? *r : *x);
            });
        }
    }
}

TEST_P(BackendContract, LeavesColumnsThatAreDoneExactlyAsTheyAre) {
    for (Index columns : column_counts) {
        const StepNumbers step(columns, 1);
        const auto p = to_device(*backend_, random_columns(301, columns, 18));
        const auto x = to_device(*backend_, random_columns(301, columns, 19));
        const auto r = to_device(*backend_, random_columns(301, columns, 20));
        const auto rr_new = backend_->make_sums(columns);
        const Columns x_before = to_host(*backend_, *x), r_before = to_host(*backend_, *r);

        backend_->advance(*sums_of(*backend_, step.rz), *sums_of(*backend_, step.pq),
                          *sums_of(*backend_, step.rr), *sums_of(*backend_, step.limit), *p, *p, *x,
                          *r, *rr_new);

        for (Index c = 0; c < columns; ++c)
            if ((c + 1) % 4 != 0) {
                EXPECT_EQ(to_host(*backend_, *x).col(c), x_before.col(c)) << c;
                EXPECT_EQ(to_host(*backend_, *r).col(c), r_before.col(c)) << c;
            }
    }
}

TEST_P(BackendContract, TurnsTheSearchDirections) {
    expect_same([&](Backend& backend, Index columns) {
        std::vector<double> rz, rz_new;
        for (Index c = 0; c < columns; ++c) {
            rz.push_back(c % 3 == 1 ? 0.0 : c % 3 == 2 ? -0.5 : 1.5 + c);
            rz_new.push_back(0.25 * c + 0.1);
        }
        const auto z = to_device(backend, random_columns(1237, columns, 21));
        const auto p = to_device(backend, random_columns(1237, columns, 22));

        backend.turn(*sums_of(backend, rz_new), *sums_of(backend, rz), *z, *p);

        return to_host(backend, *p);
    });
}

TEST_P(BackendContract, DoesNotReadTheOldDirectionAtTheStart) {
    for (Index columns : column_counts) {
        const Columns z = random_columns(301, columns, 23);
        const auto p = nan_vector(*backend_, 301, columns);
        const std::vector<double> one(columns, 1.0), zero(columns, 0.0);

        backend_->turn(*sums_of(*backend_, one), *sums_of(*backend_, zero),
                       *to_device(*backend_, z), *p);

        EXPECT_LT((to_host(*backend_, *p) - z).cwiseAbs().maxCoeff(), 1e-7);
    }
}

TEST_P(BackendContract, TakesAWholeStepOfConjugateGradients) {
    prepare(odd_model());
    constexpr double two_products = 4;  // the second rests on the rounding of the first
    for (bool of_direction : {false, true})
        expect_same(
            [&](Backend& backend, Index columns) {
                const DeviceOperator& a = backend.stiffness();
                const auto r = to_device(backend, random_state(columns, 24));
                const auto x = to_device(backend, random_state(columns, 25));
                const auto z = nan_vector(backend, a.rows(), columns);
                const auto p = nan_vector(backend, a.rows(), columns);
                const auto q = nan_vector(backend, a.rows(), columns);
                const auto zero = sums_of(backend, std::vector<double>(columns, 0.0));
                const auto rz = backend.make_sums(columns), rz_new = backend.make_sums(columns),
                           rr = backend.make_sums(columns), rr_new = backend.make_sums(columns),
                           pq = backend.make_sums(columns);

                backend.dot(*r, *r, *rr);
                backend.apply_inverse_diagonal(a, 1.0, *r, *z, rz.get());
                backend.turn(*rz, *zero, *z, *p);
                backend.apply(a, *p, *q, pq.get());
                backend.advance(*rz, *pq, *rr, *zero, *p, *q, *x, *r, *rr_new);
                backend.apply_inverse_diagonal(a, 1.0, *r, *z, rz_new.get());
                backend.turn(*rz_new, *rz, *z, *p);

                return to_host(backend, of_direction ? *p : *x);
            },
            two_products);
}

}  // namespace
}  // namespace palpate::backend_contract
