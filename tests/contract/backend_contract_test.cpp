// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "solver/backends/reference/reference_backend.hpp"
#include "solver/linear/linear_solver.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

// One body for every back end in the registry, each precision and product, for several numbers of
// columns: what it computes must be what the reference back end computes element by element in
// fp64.
namespace palpate {
namespace {

using fixtures::code_of;
using fixtures::random_columns;

struct Case {
    std::string backend;
    Precision precision;
    Product product;
};

/// One, a few, a full vector register's worth, one more than that, and twice as many.
const std::vector<Index> column_counts = {1, 3, 16, 17, 32};

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string name_of(const testing::TestParamInfo<Case>& entry) {
    const Case& c = entry.param;
    std::string name = c.backend + (c.precision == Precision::single ? "_single_" : "_double_") +
                       name_of(c.product);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

std::vector<Case> every_case() {
    std::vector<Case> cases;
    for (const std::string& backend : fixtures::backend_names())
        for (Precision precision : {Precision::single, Precision::double_})
            for (Product product : {Product::assembled, Product::matrix_free, Product::recomputed,
                                    Product::automatic})
                cases.push_back({backend, precision, product});
    return cases;
}

/// Sums of some 50 products of rounded numbers: a few tens of units in the last place.
double tolerance_of(Precision precision) { return precision == Precision::single ? 1e-5 : 1e-12; }

/// 7 x 5 x 9 cubes: 1,440 rows and 1,890 tets, no multiple of any work group. One face held, one
/// node held along y only.
Model odd_model() {
    Model model = fixtures::two_tissue_model({7, 5, 9});
    model.prescribed[3 * (model.mesh.num_nodes() - 2) + 1] = 1;
    return model;
}

std::span<const double> as_span(const Columns& c) {
    return {c.data(), static_cast<std::size_t>(c.size())};
}

std::vector<double> random_numbers(std::size_t count, unsigned seed) {
    const Columns values = random_columns(static_cast<Index>(count), 1, seed);
    return {values.data(), values.data() + count};
}

/// Some five random blocks per row, every seventh row empty, row 10 full.
BlockMatrix random_matrix(Index rows, Index columns, int block_rows, int block_columns,
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
std::vector<double> random_diagonal(const BlockMatrix& matrix, unsigned seed) {
    return random_numbers(
        static_cast<std::size_t>(matrix.num_rows()) * matrix.block_rows * matrix.block_rows, seed);
}

std::unique_ptr<DeviceVector> to_device(Backend& backend, const Columns& values) {
    auto v =
        backend.make_vector(static_cast<Index>(values.rows()), static_cast<Index>(values.cols()));
    backend.copy_in(as_span(values), *v);
    return v;
}

std::unique_ptr<DeviceVector> nan_vector(Backend& backend, Index rows, Index columns) {
    auto v = backend.make_vector(rows, columns);
    backend.fill(*v, nan);
    return v;
}

Columns to_host(Backend& backend, const DeviceVector& v) {
    Columns values(v.rows(), v.columns());
    backend.copy_out(v, {values.data(), static_cast<std::size_t>(values.size())});
    return values;
}

std::unique_ptr<DeviceSums> sums_of(Backend& backend, const std::vector<double>& values) {
    auto sums = backend.make_sums(static_cast<Index>(values.size()));
    backend.set(*sums, values);
    return sums;
}

std::vector<double> numbers_of(Backend& backend, const DeviceSums& sums) {
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

TEST_P(BackendContract, SaysWhoComputesAndHow) {
    const BackendInfo info = backend_->describe();

    EXPECT_EQ(info.backend, GetParam().backend);
    EXPECT_FALSE(info.device.empty());
    EXPECT_FALSE(info.version.empty());
    EXPECT_EQ(info.product, GetParam().product);
    if (GetParam().backend != "reference") {
        EXPECT_EQ(info.precision, GetParam().precision);
    }
    EXPECT_GE(info.compute_units, 1);
}

TEST_P(BackendContract, SaysWhichProductItChoseAndWhy) {
    if (GetParam().backend == "reference") GTEST_SKIP() << "The reference back end never measures.";
    prepare(odd_model());
    for (Index columns : column_counts) {
        const auto x = to_device(*backend_, random_state(columns, 1));
        const auto y = backend_->make_vector(model_.num_dofs(), columns);
        backend_->apply(backend_->stiffness(), *x, *y);
    }

    const std::vector<ProductChoice> choices = backend_->describe().choices;

    EXPECT_EQ(choices.empty(), GetParam().product != Product::automatic);
    for (const ProductChoice& choice : choices) {
        EXPECT_NE(choice.product, Product::automatic);
        EXPECT_GE(choice.columns, 1);
        EXPECT_NE(choice.reason.find(name_of(choice.product)), std::string::npos) << choice.reason;
    }
}

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

TEST_P(BackendContract, RefusesColumnsThatDoNotExist) {
    const auto small = to_device(*backend_, random_columns(30, 2, 7));
    const auto large = to_device(*backend_, random_columns(30, 4, 8));
    const auto longer = to_device(*backend_, random_columns(31, 4, 9));
    const auto copy = [&](DeviceVector& to, std::vector<Index> from_columns,
                          std::vector<Index> to_columns) {
        return code_of([&] { backend_->copy_columns(*small, from_columns, to, to_columns); });
    };

    EXPECT_EQ(copy(*large, {2}, {0}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {0, 1}, {0, 4}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {-1}, {0}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {0}, {-1}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {0, 1}, {0}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*longer, {0}, {0}), ErrorCode::invalid_argument);
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

TEST_P(BackendContract, ComputesTheMechanicsOfAModel) {
    prepare(odd_model());

    expect_same_mechanics(30);
    expect_right_sums(backend_->stiffness(), 60);
}

TEST_P(BackendContract, WorksOnASingleElement) {
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {10, 0, 1}, {0, 12, 0}, {1, 0, 9}};
    mesh.tets = {{0, 1, 2, 3}};
    mesh.region = {0};
    Model model = fixtures::free_model(mesh, {{25.0, 0.3}});
    fixtures::prescribe(model, {2});
    prepare(model);

    expect_same_mechanics(70);
    expect_right_sums(backend_->stiffness(), 100);
}

TEST_P(BackendContract, GivesANodeOfNoElementNoStiffness) {
    Model model = fixtures::two_tissue_model({2, 2, 2});
    model.mesh.nodes.insert(model.mesh.nodes.end(), {{99, 99, 99}, {98, 99, 99}});
    model.prescribed.insert(model.prescribed.end(), {0, 0, 0, 1, 1, 1});
    prepare(model);

    expect_same_mechanics(110);
}

TEST_P(BackendContract, GivesNoForceForARigidMotion) {
    prepare(odd_model());
    const auto force_of = [&](const Columns& x) {
        const auto y = backend_->make_vector(model_.num_dofs(), static_cast<Index>(x.cols()));
        backend_->internal_force(*to_device(*backend_, x), *y);
        return to_host(*backend_, *y);
    };
    for (Index columns : column_counts) {
        Columns x(model_.num_dofs(), columns);
        for (Index n = 0; n < model_.mesh.num_nodes(); ++n)
            for (Index c = 0; c < x.cols(); ++c)
                x.block<3, 1>(3 * n, c) =
                    Vec3(1, -2, 0.5) + 0.01 * Vec3(1 + c, 2, -1).cross(model_.mesh.nodes[n]);
        const double scale = force_of(random_state(columns, 140)).norm();

        EXPECT_LT(force_of(x).norm(), tolerance() * x.cwiseAbs().maxCoeff() * scale);
    }
}

TEST_P(BackendContract, ComputesTheStrainEnergy) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const Columns x = random_state(columns, 141);
        std::vector<double> expected(columns), actual(columns);

        oracle_->strain_energy(*to_device(*oracle_, x), expected);
        backend_->strain_energy(*to_device(*backend_, x), actual);

        expect_close(actual, expected);
    }
}

TEST_P(BackendContract, DifferentiatesWithRespectToTheModuli) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const Columns x = random_state(columns, 142);
        const Columns lambda = x + 0.7 * random_state(columns, 143);
        std::vector<double> expected(2), actual(2);

        oracle_->parameter_gradient(*to_device(*oracle_, lambda), *to_device(*oracle_, x),
                                    expected);
        backend_->parameter_gradient(*to_device(*backend_, lambda), *to_device(*backend_, x),
                                     actual);

        expect_close(actual, expected);
    }
}

TEST_P(BackendContract, TakesNewModuliForThePreparedModel) {
    prepare(odd_model());
    const auto x = to_device(*backend_, random_state(3, 144));
    const auto y = backend_->make_vector(model_.num_dofs(), 3);
    backend_->apply(backend_->stiffness(), *x, *y);

    const std::vector<double> moduli = {3.0, 410.0};
    backend_->set_stiffness(moduli);
    oracle_->set_stiffness(moduli);

    expect_same_mechanics(150);
}

TEST_P(BackendContract, TakesAnotherModel) {
    prepare(odd_model());
    expect_same_mechanics(180);

    prepare(fixtures::two_tissue_model({3, 3, 4}));

    expect_same_mechanics(210);
}

struct Shape {
    Index rows, columns;
    int block_rows, block_columns;
};

const std::vector<Shape> matrix_shapes = {
    {257, 257, 3, 3}, {129, 129, 6, 6}, {257, 43, 3, 6}, {43, 257, 6, 3}, {11, 1, 2, 1}};

TEST_P(BackendContract, MultipliesWithAnyBlockMatrix) {
    for (const Shape& shape : matrix_shapes) {
        const BlockMatrix matrix =
            random_matrix(shape.rows, shape.columns, shape.block_rows, shape.block_columns, 240);
        const auto a = backend_->make_operator(matrix, {});
        const auto expected = oracle_->make_operator(matrix, {});

        EXPECT_EQ(a->rows(), shape.rows * shape.block_rows);
        EXPECT_EQ(a->columns(), shape.columns * shape.block_columns);
        expect_same_products(*a, *expected, 241);
    }
}

TEST_P(BackendContract, SmoothesWithASquareBlockMatrix) {
    for (int block : {1, 3, 6}) {
        const BlockMatrix matrix = random_matrix(137, 137, block, block, 250);
        const std::vector<double> diagonal = random_diagonal(matrix, 252);
        const auto a = backend_->make_operator(matrix, diagonal);
        const auto expected = oracle_->make_operator(matrix, diagonal);

        expect_same_smoothing(*a, *expected, 253);
        expect_right_sums(*a, 260);
    }
}

TEST_P(BackendContract, TakesNewValuesInTheSamePattern) {
    BlockMatrix matrix = random_matrix(137, 137, 6, 6, 270);
    const auto a = backend_->make_operator(matrix, random_diagonal(matrix, 272));
    const auto expected = oracle_->make_operator(matrix, random_diagonal(matrix, 272));
    matrix.blocks = random_numbers(matrix.blocks.size(), 273);
    const std::vector<double> diagonal = random_diagonal(matrix, 274);

    backend_->set_values(*a, matrix, diagonal);
    oracle_->set_values(*expected, matrix, diagonal);

    expect_same_products(*a, *expected, 275);
    expect_same_smoothing(*a, *expected, 280);
}

TEST_P(BackendContract, MultipliesWithAMatrixWithoutBlocks) {
    BlockMatrix matrix;
    matrix.num_columns = 4;
    matrix.graph.offsets.assign(6, 0);
    const auto a = backend_->make_operator(matrix, {});
    const auto y = nan_vector(*backend_, 15, 3);

    backend_->apply(*a, *to_device(*backend_, random_columns(12, 3, 290)), *y);

    EXPECT_TRUE(to_host(*backend_, *y).isZero(0));
}

TEST_P(BackendContract, RefusesAMatrixThatDoesNotFitTheOperator) {
    const BlockMatrix matrix = random_matrix(23, 23, 3, 3, 291);
    const std::vector<double> diagonal = random_diagonal(matrix, 292);
    const auto a = backend_->make_operator(matrix, diagonal);
    const auto bare = backend_->make_operator(matrix, {});
    const auto x = to_device(*backend_, random_columns(69, 2, 293));
    const auto y = backend_->make_vector(69, 2), narrow = backend_->make_vector(69, 1);
    const auto shorter = backend_->make_vector(66, 2);
    const BlockMatrix wider = random_matrix(23, 24, 3, 3, 294);
    const std::vector<std::function<void()>> calls = {
        [&] { backend_->set_values(*a, wider, {}); },
        [&] { backend_->set_values(*a, random_matrix(22, 23, 3, 3, 295), {}); },
        [&] { backend_->set_values(*a, matrix, std::span(diagonal).first(9)); },
        [&] { backend_->make_operator(matrix, std::span(diagonal).first(9)); },
        [&] { backend_->apply_inverse_diagonal(*bare, 1, *x, *y); },
        [&] { backend_->smooth(*bare, *x, *x, 1, 0, 1, *y); },
        [&] { backend_->apply(*a, *x, *narrow); },
        [&] { backend_->apply(*a, *shorter, *y); },
        [&] { backend_->apply(*a, *x, *shorter); },
        [&] { backend_->apply(*a, *y, *y); },
        [&] { backend_->apply_add(*a, *x, *shorter); },
        [&] { backend_->apply_add(*a, *y, *y); },
        [&] { backend_->residual(*a, *shorter, *x, *y); },
        [&] { backend_->residual(*a, *x, *y, *y); },
        [&] { backend_->smooth(*a, *shorter, *x, 1, 0, 1, *y); },
        [&] { backend_->smooth(*a, *x, *y, 1, 0, 1, *y); },
        [&] { backend_->apply_inverse_diagonal(*a, 1, *shorter, *shorter); },
    };

    for (std::size_t i = 0; i < calls.size(); ++i)
        EXPECT_EQ(code_of(calls[i]), ErrorCode::invalid_argument) << "call " << i;
}

TEST_P(BackendContract, RepeatsItsResultsBitForBit) {
    prepare(odd_model());
    const auto run = [&](Index columns) {
        const DeviceOperator& a = backend_->stiffness();
        const auto x = to_device(*backend_, random_state(columns, 300));
        const auto y = nan_vector(*backend_, a.rows(), columns);
        const auto z = nan_vector(*backend_, a.rows(), columns);
        const auto xy = backend_->make_sums(columns), zy = backend_->make_sums(columns);
        backend_->apply(a, *x, *y, xy.get());
        backend_->smooth(a, *y, *x, 1, 0, 0.5, *z, zy.get());
        std::vector<double> results = numbers_of(*backend_, *xy);
        for (double number : numbers_of(*backend_, *zy)) results.push_back(number);
        const std::size_t num_sums = results.size();
        results.resize(num_sums + columns + model_.materials.size());
        backend_->strain_energy(*x, std::span(results).subspan(num_sums, columns));
        backend_->parameter_gradient(*y, *x, std::span(results).subspan(num_sums + columns));
        const Columns values = to_host(*backend_, *z);
        results.insert(results.end(), values.data(), values.data() + values.size());
        return results;
    };

    for (Index columns : column_counts) EXPECT_EQ(run(columns), run(columns));
}

TEST_P(BackendContract, RefusesSizesThatDoNotMatch) {
    prepare(odd_model());
    const DeviceOperator& stiffness = backend_->stiffness();
    for (Index columns : column_counts) {
        const auto state = to_device(*backend_, random_state(columns, 310));
        const auto small = to_device(*backend_, random_columns(30, columns, 311));
        const auto large = backend_->make_vector(33, columns);
        const auto sums = backend_->make_sums(columns), other = backend_->make_sums(columns);
        const auto wide = backend_->make_sums(columns + 1);
        backend_->set(*sums, std::vector<double>(columns, 1.0));
        std::vector<double> many(columns + 1);
        const auto advance = [&](const DeviceSums& rz, const DeviceVector& p, DeviceSums& rr_new) {
            const auto x = backend_->make_vector(30, columns);
            backend_->advance(rz, *sums, *sums, *sums, p, *small, *x, *x, rr_new);
        };
        const std::vector<std::function<void()>> calls = {
            [&] { backend_->make_vector(-1, columns); },
            [&] { backend_->make_vector(3, 0); },
            [&] { backend_->make_sums(0); },
            [&] { backend_->copy_in(many, *large); },
            [&] { backend_->copy_out(*large, many); },
            [&] { backend_->set(*sums, many); },
            [&] { backend_->read(*sums, many); },
            [&] { backend_->dot(*small, *large, *sums); },
            [&] { backend_->dot(*small, *small, *wide); },
            [&] { advance(*wide, *small, *other); },
            [&] { advance(*sums, *large, *other); },
            [&] { advance(*sums, *small, *sums); },
            [&] { backend_->turn(*sums, *sums, *small, *large); },
            [&] { backend_->turn(*wide, *sums, *small, *small); },
            [&] { backend_->apply(stiffness, *small, *large); },
            [&] { backend_->apply(stiffness, *state, *state); },
            [&] { backend_->apply_inverse_diagonal(stiffness, 1, *small, *large); },
            [&] { backend_->internal_force(*small, *large); },
            [&] { backend_->internal_force(*state, *state); },
            [&] { backend_->strain_energy(*small, std::span(many).first(columns)); },
            [&] { backend_->strain_energy(*state, many); },
            [&] { backend_->parameter_gradient(*small, *large, std::span(many).first(1)); },
            [&] { backend_->set_stiffness(std::vector<double>{1.0}); },
            [&] {
                backend_->set_stiffness(std::vector<double>{1.0, 0.0});
            },
        };

        for (std::size_t i = 0; i < calls.size(); ++i)
            EXPECT_EQ(code_of(calls[i]), ErrorCode::invalid_argument) << "call " << i;
    }
}

TEST_P(BackendContract, WantsAModelBeforeItGivesItsStiffness) {
    EXPECT_EQ(code_of([&] { backend_->stiffness(); }), ErrorCode::invalid_argument);
}

TEST_P(BackendContract, RefusesAModelThatIsNotValid) {
    Model model = odd_model();
    std::swap(model.mesh.tets[5][0], model.mesh.tets[5][1]);

    EXPECT_EQ(code_of([&] { backend_->prepare(model); }), ErrorCode::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Registry, BackendContract, testing::ValuesIn(every_case()),
                         [](const auto& entry) { return name_of(entry); });

TEST(Registry, RefusesABackEndThatIsNotCompiledInAndNamesTheOthers) {
    try {
        make_backend("abacus", {});
        FAIL() << "no exception";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        EXPECT_NE(std::string(error.what()).find("abacus"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("reference"), std::string::npos);
    }
}

TEST(Registry, AlwaysHoldsTheReferenceBackEnd) {
    const auto names = fixtures::backend_names();

    EXPECT_EQ(std::count(names.begin(), names.end(), "reference"), 1);
    for (const BackendEntry& entry : backend_registry())
        for (const DeviceInfo& device : entry.devices()) EXPECT_EQ(device.backend, entry.name);
}

}  // namespace
}  // namespace palpate
