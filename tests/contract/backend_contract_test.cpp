// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

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

const std::vector<Index> column_counts = {1, 3, 16};

std::string name_of(const testing::TestParamInfo<Case>& entry) {
    const Case& c = entry.param;
    return c.backend + (c.precision == Precision::single ? "_single" : "_double") +
           (c.product == Product::assembled ? "_assembled" : "_matrix_free");
}

std::vector<Case> every_case() {
    std::vector<Case> cases;
    for (const std::string& backend : fixtures::backend_names())
        for (Precision precision : {Precision::single, Precision::double_})
            for (Product product : {Product::assembled, Product::matrix_free})
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

class BackendContract : public testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        const Case& c = GetParam();
        const BackendOptions options{c.precision, c.product, ""};
        auto [backend, reason] = fixtures::try_backend(c.backend, options);
        if (!backend) GTEST_SKIP() << reason;
        backend_ = std::move(backend);
        oracle_ = make_reference_backend({Precision::double_, Product::matrix_free, ""});
    }

    void prepare(const Model& model) {
        model_ = model;
        backend_->prepare(model);
        oracle_->prepare(model);
    }

    static std::unique_ptr<DeviceVector> to_device(Backend& backend, const Columns& values) {
        auto v = backend.make_vector(static_cast<Index>(values.rows()),
                                     static_cast<Index>(values.cols()));
        backend.copy_in(as_span(values), *v);
        return v;
    }

    static Columns to_host(Backend& backend, const DeviceVector& v) {
        Columns values(v.rows(), v.columns());
        backend.copy_out(v, {values.data(), static_cast<std::size_t>(values.size())});
        return values;
    }

    using Operation = void (Backend::*)(const DeviceVector&, DeviceVector&);

    static Columns result_of(Backend& backend, Operation operation, const Columns& x) {
        const auto in = to_device(backend, x);
        const auto out = backend.make_vector(in->rows(), in->columns());
        (backend.*operation)(*in, *out);
        return to_host(backend, *out);
    }

    void expect_same(Operation operation, unsigned seed) {
        for (Index columns : column_counts) {
            const Columns x = random_columns(model_.num_dofs(), columns, seed);

            const Columns expected = result_of(*oracle_, operation, x);
            const Columns actual = result_of(*backend_, operation, x);

            for (Index c = 0; c < x.cols(); ++c)
                EXPECT_LT((actual.col(c) - expected.col(c)).norm(),
                          tolerance() * expected.col(c).norm());
        }
    }

    void expect_close(std::span<const double> actual, std::span<const double> expected,
                      double scale = 1) {
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(actual[i], expected[i], scale * tolerance() * std::abs(expected[i])) << i;
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

TEST_P(BackendContract, CombinesVectorsColumnByColumn) {
    for (Index columns : column_counts) {
        const Columns x = random_columns(1237, columns, 3), y = random_columns(1237, columns, 4);
        const Columns factors = random_columns(2, columns, 5);
        const auto device_x = to_device(*backend_, x);
        const auto device_y = to_device(*backend_, y);

        backend_->axpby(as_span(factors).first(columns), *device_x, as_span(factors).last(columns),
                        *device_y);

        const Columns expected = (x.array().rowwise() * factors.row(0).array() +
                                  y.array().rowwise() * factors.row(1).array());
        EXPECT_LT((to_host(*backend_, *device_y) - expected).cwiseAbs().maxCoeff(), 4e-7);
    }
}

TEST_P(BackendContract, DoesNotReadTheOldContentWhenBetaIsZero) {
    for (Index columns : column_counts) {
        const Columns x = random_columns(301, columns, 6);
        const auto device_x = to_device(*backend_, x);
        const auto device_y = backend_->make_vector(301, columns);
        backend_->fill(*device_y, std::numeric_limits<double>::quiet_NaN());
        const std::vector<double> two(columns, 2.0), zero(columns, 0.0);

        backend_->axpby(two, *device_x, zero, *device_y);

        EXPECT_LT((to_host(*backend_, *device_y) - 2 * x).cwiseAbs().maxCoeff(), 4e-7);
    }
}

TEST_P(BackendContract, SumsProductsPerColumn) {
    for (Index columns : column_counts) {
        const Columns x = random_columns(2999, columns, 7);
        const Columns y = x + 0.5 * random_columns(2999, columns, 8);
        std::vector<double> result(columns);

        backend_->dot(*to_device(*backend_, x), *to_device(*backend_, y), result);

        for (Index c = 0; c < x.cols(); ++c)
            EXPECT_NEAR(result[c], x.col(c).dot(y.col(c)), tolerance() * x.col(c).squaredNorm());
    }
}

TEST_P(BackendContract, ComputesInternalForces) {
    prepare(odd_model());

    expect_same(&Backend::internal_force, 9);
}

TEST_P(BackendContract, AppliesTheConstrainedStiffness) {
    prepare(odd_model());

    expect_same(&Backend::apply_stiffness, 10);
}

TEST_P(BackendContract, AppliesTheBlockJacobiPreconditioner) {
    prepare(odd_model());

    expect_same(&Backend::apply_block_jacobi, 11);
}

TEST_P(BackendContract, WorksOnASingleElement) {
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {10, 0, 1}, {0, 12, 0}, {1, 0, 9}};
    mesh.tets = {{0, 1, 2, 3}};
    mesh.region = {0};
    Model model = fixtures::free_model(mesh, {{25.0, 0.3}});
    fixtures::prescribe(model, {2});
    prepare(model);

    expect_same(&Backend::internal_force, 12);
    expect_same(&Backend::apply_stiffness, 13);
    expect_same(&Backend::apply_block_jacobi, 14);
}

TEST_P(BackendContract, GivesNoForceForARigidMotion) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        Columns x(model_.num_dofs(), columns);
        for (Index n = 0; n < model_.mesh.num_nodes(); ++n)
            for (Index c = 0; c < x.cols(); ++c)
                x.block<3, 1>(3 * n, c) =
                    Vec3(1, -2, 0.5) + 0.01 * Vec3(1 + c, 2, -1).cross(model_.mesh.nodes[n]);
        const Columns scale = result_of(*backend_, &Backend::internal_force,
                                        random_columns(model_.num_dofs(), columns, 15));

        const Columns force = result_of(*backend_, &Backend::internal_force, x);

        EXPECT_LT(force.norm(), tolerance() * x.cwiseAbs().maxCoeff() * scale.norm());
    }
}

TEST_P(BackendContract, ComputesTheStrainEnergy) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const Columns x = random_columns(model_.num_dofs(), columns, 16);
        std::vector<double> expected(columns), actual(columns);

        oracle_->strain_energy(*to_device(*oracle_, x), expected);
        backend_->strain_energy(*to_device(*backend_, x), actual);

        expect_close(actual, expected);
    }
}

TEST_P(BackendContract, DifferentiatesWithRespectToTheModuli) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const Columns x = random_columns(model_.num_dofs(), columns, 17);
        const Columns lambda = x + 0.7 * random_columns(model_.num_dofs(), columns, 18);
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
    const std::vector<double> moduli = {3.0, 410.0};
    backend_->set_stiffness(moduli);
    oracle_->set_stiffness(moduli);

    expect_same(&Backend::internal_force, 19);
    expect_same(&Backend::apply_stiffness, 20);
    expect_same(&Backend::apply_block_jacobi, 21);
}

TEST_P(BackendContract, TakesAnotherModel) {
    prepare(odd_model());
    expect_same(&Backend::apply_stiffness, 22);

    prepare(fixtures::two_tissue_model({3, 3, 4}));

    expect_same(&Backend::apply_stiffness, 23);
    expect_same(&Backend::internal_force, 24);
}

TEST_P(BackendContract, RepeatsItsResultsBitForBit) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const Columns x = random_columns(model_.num_dofs(), columns, 25);
        const auto device_x = to_device(*backend_, x);
        std::vector<double> first(columns), second(columns);

        const Columns force = result_of(*backend_, &Backend::apply_stiffness, x);
        backend_->dot(*device_x, *device_x, first);
        backend_->dot(*device_x, *device_x, second);

        EXPECT_EQ(force, result_of(*backend_, &Backend::apply_stiffness, x));
        EXPECT_EQ(first, second);
    }
}

TEST_P(BackendContract, RefusesSizesThatDoNotMatch) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const auto small = to_device(*backend_, random_columns(30, columns, 26));
        const auto large = backend_->make_vector(33, columns);
        const std::vector<double> few(columns + 1);
        std::vector<double> many(columns + 1);
        const std::vector<std::function<void()>> calls = {
            [&] { backend_->copy_in(few, *large); },
            [&] { backend_->copy_out(*large, many); },
            [&] { backend_->axpby(few, *small, few, *small); },
            [&] { backend_->dot(*small, *large, std::span(many).first(columns)); },
            [&] { backend_->internal_force(*small, *large); },
            [&] { backend_->apply_stiffness(*small, *large); },
            [&] { backend_->apply_block_jacobi(*small, *large); },
            [&] { backend_->strain_energy(*small, std::span(many).first(columns)); },
            [&] { backend_->set_stiffness(std::vector<double>{1.0}); },
        };

        for (std::size_t i = 0; i < calls.size(); ++i)
            EXPECT_EQ(code_of(calls[i]), ErrorCode::invalid_argument) << "call " << i;
    }
}

TEST_P(BackendContract, RefusesAModelThatIsNotValid) {
    Model model = odd_model();
    std::swap(model.mesh.tets[5][0], model.mesh.tets[5][1]);

    EXPECT_EQ(code_of([&] { backend_->prepare(model); }), ErrorCode::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Registry, BackendContract, testing::ValuesIn(every_case()), name_of);

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
