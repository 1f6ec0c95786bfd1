// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/adjoint.hpp"

#include <gtest/gtest.h>

#include "solver/linear/make_linear_solver.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/linear_solvers.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

constexpr double gradient_tolerance = 1e-6;

/// J(u) = sum w_i sin(u_i) + 1/2 (sum v_i u_i)^2: smooth, and neither linear nor quadratic.
struct Objective {
    Eigen::VectorXd w, v;

    double value(const Eigen::VectorXd& u) const {
        return w.dot(u.array().sin().matrix()) + 0.5 * std::pow(v.dot(u), 2);
    }
    Eigen::VectorXd derivative(const Eigen::VectorXd& u) const {
        return w.cwiseProduct(u.array().cos().matrix()) + v.dot(u) * v;
    }
};

struct Problem {
    Model model = fixtures::two_tissue_model({4, 5, 4});
    Columns prescribed;
    Objective objective;

    Problem() {
        fixtures::prescribe(model, fixtures::select_nodes(model.mesh, [](const Vec3& p) {
                                return p.z() > 39.9 && p.x() < 25;
                            }));
        const Index n = model.num_dofs();
        prescribed = 2 * fixtures::random_columns(n, 1, 1);
        for (Index d = 0; d < n; ++d)
            if (!model.prescribed[d]) prescribed(d, 0) = 0;
        objective = {fixtures::random_columns(n, 1, 2), 0.1 * fixtures::random_columns(n, 1, 3)};
    }

    std::unique_ptr<LinearSolver> solver(const std::string& backend) const {
        LinearSolverOptions options = fixtures::solver_on(backend);
        options.relative_tolerance = 1e-10;
        return make_linear_solver(model, options);
    }

    Eigen::VectorXd solve(const std::string& backend) const {
        Columns u;
        EXPECT_TRUE(solver(backend)->solve(prescribed, u).converged);
        return u.col(0);
    }

    double value() const { return objective.value(solve("reference")); }
};

class Adjoint : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        if (const auto reason = fixtures::reason_to_skip(GetParam())) GTEST_SKIP() << *reason;
        const Eigen::VectorXd u = problem_.solve(GetParam());
        gradient_ = adjoint_gradient(problem_.model, *problem_.solver(GetParam()), u,
                                     problem_.objective.derivative(u));
    }

    Problem problem_;
    AdjointGradient gradient_;
};

TEST_P(Adjoint, AgreesWithCentralDifferencesInTheModuli) {
    for (std::size_t r = 0; r < problem_.model.materials.size(); ++r) {
        Problem plus = problem_, minus = problem_;
        const double step = 1e-4 * problem_.model.materials[r].stiffness_kpa;
        plus.model.materials[r].stiffness_kpa += step;
        minus.model.materials[r].stiffness_kpa -= step;

        const double expected = (plus.value() - minus.value()) / (2 * step);

        EXPECT_NEAR(gradient_.stiffness_kpa[r], expected, gradient_tolerance * std::abs(expected));
    }
}

TEST_P(Adjoint, AgreesWithCentralDifferencesInThePrescribedDisplacements) {
    const double step = 1e-4;
    const double scale = gradient_.displacement.cwiseAbs().maxCoeff();
    int checked = 0;
    for (Index d = 0; d < problem_.model.num_dofs(); d += 13) {
        if (!problem_.model.prescribed[d]) {
            EXPECT_EQ(gradient_.displacement[d], 0);
            continue;
        }
        Problem plus = problem_, minus = problem_;
        plus.prescribed(d, 0) += step;
        minus.prescribed(d, 0) -= step;

        const double expected = (plus.value() - minus.value()) / (2 * step);

        EXPECT_NEAR(gradient_.displacement[d], expected, gradient_tolerance * scale);
        ++checked;
    }
    EXPECT_GE(checked, 5);
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, Adjoint, testing::ValuesIn(fixtures::backend_names()),
                         [](const auto& entry) { return entry.param; });

TEST(AdjointReference, RefusesVectorsOfAnotherSize) {
    const Problem problem;
    const Eigen::VectorXd u = Eigen::VectorXd::Zero(problem.model.num_dofs());
    const Eigen::VectorXd short_u = u.head(u.size() - 3);

    const auto solver = problem.solver("reference");

    EXPECT_EQ(fixtures::code_of([&] { adjoint_gradient(problem.model, *solver, u, short_u); }),
              ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace palpate
