// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/make_linear_solver.hpp"

#include <gtest/gtest.h>

#include "solver/linear/direct.hpp"
#include "solver/linear/factor_libraries.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

// One body for every linear solver: every direct library, and block CG on every back end of the
// registry.
namespace palpate {
namespace {

using fixtures::code_of;
using fixtures::random_columns;

struct Case {
    std::string name;
    std::string direct_library;  ///< empty: block CG on `backend`
    std::string backend;
    LinearMethod method = LinearMethod::direct;
    Precision precision = Precision::double_;
    Product product = Product::assembled;
};

std::vector<Case> every_case() {
    std::vector<Case> cases;
    for (const std::string& library : sparse_factor_names())
        cases.push_back({"direct_" + library, library, ""});
    for (const std::string& backend : fixtures::backend_names())
        for (LinearMethod method : {LinearMethod::jacobi, LinearMethod::multigrid})
            for (Precision precision : {Precision::double_, Precision::single})
                for (Product product : {Product::assembled, Product::matrix_free}) {
                    if (backend == "reference" && precision == Precision::single) continue;
                    const bool is_assembled = product == Product::assembled;
                    cases.push_back({std::string(name_of(method)) + "_" + backend +
                                         (precision == Precision::double_ ? "_double" : "_single") +
                                         (is_assembled ? "_assembled" : "_matrix_free"),
                                     "", backend, method, precision, product});
                }
    return cases;
}

constexpr double answer_tolerance = 1e-6;  ///< residual 1e-8 times the condition of the test model

class LinearSolverContract : public testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        if (!GetParam().direct_library.empty()) return;
        if (const auto reason = fixtures::reason_to_skip(GetParam().backend, device_options()))
            GTEST_SKIP() << *reason;
    }

    static BackendOptions device_options() {
        return {GetParam().precision, GetParam().product, ""};
    }

    static std::unique_ptr<LinearSolver> make(const Model& model,
                                              LinearSolverOptions options = {}) {
        options.method = GetParam().method;
        options.direct_library = GetParam().direct_library;
        options.backend = GetParam().direct_library.empty() ? GetParam().backend : "reference";
        options.device = device_options();
        return make_linear_solver(model, options);
    }

    static Columns exact(const Model& model, const Columns& b) {
        LinearSolverOptions options;
        options.direct_library = "eigen";
        options.relative_tolerance = 1e-13;
        Columns x;
        make_direct_solver(model, options)->solve(b, x);
        return x;
    }
};

/// Largest |b - K x| / |b - K x_0| over the columns with the reference back end's K, where x_0
/// holds the prescribed displacements only.
double worst_residual(const Model& model, const Columns& b, const Columns& x) {
    const auto backend = make_backend("reference", {Precision::double_, Product::matrix_free, ""});
    backend->prepare(model);
    const auto residual = [&](const Columns& u) {
        auto in = backend->make_vector(model.num_dofs(), static_cast<Index>(u.cols()));
        auto out = backend->make_vector(model.num_dofs(), static_cast<Index>(u.cols()));
        Columns force(u.rows(), u.cols());
        backend->copy_in({u.data(), static_cast<std::size_t>(u.size())}, *in);
        backend->internal_force(*in, *out);
        backend->copy_out(*out, {force.data(), static_cast<std::size_t>(force.size())});
        Columns r = b - force;
        for (Index d = 0; d < r.rows(); ++d)
            if (model.prescribed[d]) r.row(d).setZero();
        return r;
    };
    Columns lifted = Columns::Zero(x.rows(), x.cols());
    for (Index d = 0; d < x.rows(); ++d)
        if (model.prescribed[d]) lifted.row(d) = b.row(d);
    return residual(x).colwise().norm().cwiseQuotient(residual(lifted).colwise().norm()).maxCoeff();
}

TEST_P(LinearSolverContract, MeetsTheToleranceForAnyNumberOfColumns) {
    const Model model = fixtures::two_tissue_model({5, 7, 6});
    LinearSolverOptions options;
    options.columns_per_batch = 4;
    const auto solver = make(model, options);

    for (Index columns : {1, 3, 4, 11}) {
        const Columns b = random_columns(model.num_dofs(), columns, columns);
        Columns x;
        const LinearSolverSummary summary = solver->solve(b, x);

        EXPECT_TRUE(summary.converged) << summary.message;
        EXPECT_LE(summary.relative_residual, options.relative_tolerance);
        EXPECT_LE(worst_residual(model, b, x), 1.01 * options.relative_tolerance);
        EXPECT_LT((x - exact(model, b)).norm(), answer_tolerance * x.norm());
    }
}

TEST_P(LinearSolverContract, AgreesWithTheReferenceToManyDigits) {
    const Model model = fixtures::two_tissue_model({9, 10, 11});
    const Columns b = random_columns(model.num_dofs(), 5, 9);
    LinearSolverOptions options;
    options.relative_tolerance = 1e-12;
    Columns x;

    const LinearSolverSummary summary = make(model, options)->solve(b, x);

    // Single precision is refined in double on the host: both reach the same digits.
    EXPECT_TRUE(summary.converged) << summary.message << " at " << summary.relative_residual;
    const Columns expected = exact(model, b);
    for (Index c = 0; c < x.cols(); ++c)
        EXPECT_LT((x.col(c) - expected.col(c)).norm(), 1e-8 * expected.col(c).norm()) << c;
}

TEST_P(LinearSolverContract, TakesPrescribedDisplacementsFromTheRightHandSide) {
    const Model model = fixtures::two_tissue_model({5, 7, 6});
    Columns b = Columns::Zero(model.num_dofs(), 2);
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) b.row(d) << d % 3, 0.25;
    Columns x;

    const LinearSolverSummary summary = make(model)->solve(b, x);

    // Nothing else holds the box: it moves rigidly by (0, 1, 2) and by (0.25, 0.25, 0.25).
    EXPECT_TRUE(summary.converged) << summary.message;
    for (Index d = 0; d < model.num_dofs(); ++d) {
        EXPECT_NEAR(x(d, 0), d % 3, 1e-6);
        EXPECT_NEAR(x(d, 1), 0.25, 1e-6);
    }
}

TEST_P(LinearSolverContract, AnswersZeroWithZero) {
    const Model model = fixtures::two_tissue_model({4, 4, 5});
    Columns b = random_columns(model.num_dofs(), 3, 2);
    b.col(1).setZero();
    Columns x;

    const LinearSolverSummary summary = make(model)->solve(b, x);

    EXPECT_TRUE(summary.converged);
    EXPECT_TRUE(x.col(1).isZero(0));
    EXPECT_GT(x.col(0).norm(), 0);
    Columns guess = Columns::Ones(model.num_dofs(), 1);
    make(model)->solve(Columns::Zero(model.num_dofs(), 1), guess);
    EXPECT_TRUE(guess.isZero(0));
}

TEST_P(LinearSolverContract, ServesColumnsOfVeryDifferentSize) {
    const Model model = fixtures::two_tissue_model({4, 4, 5});
    Columns b = random_columns(model.num_dofs(), 3, 3);
    b.col(0) *= 1e-30;
    b.col(2) *= 1e30;
    Columns x;

    const LinearSolverSummary summary = make(model)->solve(b, x);

    EXPECT_TRUE(summary.converged) << summary.message;
    EXPECT_LE(worst_residual(model, b, x), 1.01e-8);
}

TEST_P(LinearSolverContract, ReachesTheToleranceWithAStiffInclusion) {
    Model model = fixtures::two_tissue_model({5, 7, 6});
    model.materials = {{2.0, 0.35}, {2000.0, 0.45}};
    const Columns b = random_columns(model.num_dofs(), 2, 4);
    Columns x;

    const LinearSolverSummary summary = make(model)->solve(b, x);

    EXPECT_TRUE(summary.converged) << summary.message;
    EXPECT_LE(worst_residual(model, b, x), 1.01e-8);
}

TEST_P(LinearSolverContract, TakesNewModuli) {
    Model model = fixtures::two_tissue_model({4, 4, 5});
    const Columns b = random_columns(model.num_dofs(), 2, 5);
    const auto solver = make(model);
    Columns x, first;
    solver->solve(b, first);

    solver->set_stiffness(std::vector<double>{20.0, 7.0});
    solver->solve(b, x);

    model.materials[0].stiffness_kpa = 20.0;
    model.materials[1].stiffness_kpa = 7.0;
    EXPECT_LT((x - exact(model, b)).norm(), answer_tolerance * x.norm());
    EXPECT_GT((x - first).norm(), 0.1 * x.norm());
}

TEST_P(LinearSolverContract, StopsAtOnceAtTheAnswer) {
    const Model model = fixtures::two_tissue_model({4, 4, 5});
    const Columns b = random_columns(model.num_dofs(), 2, 6);
    Columns x = exact(model, b);

    const LinearSolverSummary summary = make(model)->solve(b, x);

    EXPECT_TRUE(summary.converged);
    EXPECT_EQ(summary.iterations, 0);
}

TEST_P(LinearSolverContract, RefusesValuesThatAreNotFinite) {
    const Model model = fixtures::two_tissue_model({4, 4, 5});
    Columns b = random_columns(model.num_dofs(), 2, 7);
    b(model.num_dofs() - 1, 1) = std::numeric_limits<double>::quiet_NaN();
    Columns x;

    EXPECT_EQ(code_of([&] { make(model)->solve(b, x); }), ErrorCode::solve_failed);
}

TEST_P(LinearSolverContract, RefusesARightHandSideOfAnotherSize) {
    const Model model = fixtures::two_tissue_model({4, 4, 5});
    Columns x;

    const Columns b = Columns::Zero(model.num_dofs() - 3, 1);

    EXPECT_EQ(code_of([&] { make(model)->solve(b, x); }), ErrorCode::invalid_argument);
}

TEST_P(LinearSolverContract, RepeatsItsAnswerBitForBit) {
    const Model model = fixtures::two_tissue_model({4, 4, 5});
    const Columns b = random_columns(model.num_dofs(), 5, 8);
    const auto solver = make(model);
    Columns first, second;

    solver->solve(b, first);
    solver->solve(b, second);

    EXPECT_EQ(first, second);
}

TEST_P(LinearSolverContract, GivesTheSameBitsInASecondSolver) {
    const Model model = fixtures::two_tissue_model({9, 9, 9});
    const Columns b = random_columns(model.num_dofs(), 2, 8);
    Columns first, second;

    make(model)->solve(b, first);
    make(model)->solve(b, second);

    EXPECT_EQ(first, second);
}

INSTANTIATE_TEST_SUITE_P(EverySolver, LinearSolverContract, testing::ValuesIn(every_case()),
                         [](const auto& entry) { return entry.param.name; });

}  // namespace
}  // namespace palpate
