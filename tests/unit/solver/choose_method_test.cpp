// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/choose_method.hpp"

#include <gtest/gtest.h>

#include "solver/linear/make_linear_solver.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

BackendInfo device_of(const std::string& backend, const std::string& type) {
    BackendInfo info;
    info.backend = backend;
    info.type = type;
    return info;
}
const BackendInfo cpu = device_of("opencl", "CPU");
const BackendInfo gpu = device_of("opencl", "GPU");
const BackendInfo host = device_of("reference", "host");

LinearSolverOptions with_columns(Index columns) {
    LinearSolverOptions options;
    options.expected_columns = columns;
    return options;
}

TEST(ChooseMethod, TakesWhatWasAskedForAtAnySize) {
    for (LinearMethod method :
         {LinearMethod::multigrid, LinearMethod::jacobi, LinearMethod::direct})
        for (Index num_dofs : {3, 18000, 3000000})
            for (const BackendInfo& device : {cpu, gpu, host}) {
                LinearSolverOptions options = with_columns(3000);
                options.backend = device.backend;
                options.method = method;

                const MethodChoice choice = choose_method(options, num_dofs, device);

                EXPECT_EQ(choice.method, method);
                EXPECT_EQ(choice.reason.substr(0, 9), "asked for");
            }
}

TEST(ChooseMethod, SaysThatADirectSolveLeavesTheDeviceIdle) {
    LinearSolverOptions options;
    options.method = LinearMethod::direct;

    EXPECT_EQ(choose_method(options, 18000, cpu).reason,
              "asked for; factorising is host work, the opencl back end is not used");
}

TEST(ChooseMethod, FactorisesForThousandsOfColumnsAndIteratesForOne) {
    const MethodChoice many = choose_method(with_columns(3402), 17646, cpu);
    const MethodChoice one = choose_method(with_columns(1), 90000, cpu);

    EXPECT_EQ(many.method, LinearMethod::direct);
    EXPECT_EQ(many.reason,
              "17,646 degrees of freedom and 3,402 columns: factorising once on the host is "
              "cheapest");
    EXPECT_EQ(one.method, LinearMethod::multigrid);
    EXPECT_EQ(one.reason, "90,000 degrees of freedom and 1 column: a factorisation would not pay");
}

TEST(ChooseMethod, FactorisesTinyModelsRatherThanStartADevice) {
    EXPECT_EQ(choose_method(with_columns(1), 3000, cpu).method, LinearMethod::direct);
}

TEST(ChooseMethod, NeverFactorisesWhatDoesNotFitIntoMemory) {
    EXPECT_EQ(choose_method(with_columns(1000000), 3000000, cpu).method, LinearMethod::multigrid);
}

TEST(ChooseMethod, TurnsToAGraphicsCardEarlier) {
    Index columns = 1;
    while (choose_method(with_columns(columns), 40000, cpu).method != LinearMethod::direct)
        ++columns;

    EXPECT_GT(columns, 1);
    EXPECT_EQ(choose_method(with_columns(columns), 40000, gpu).method, LinearMethod::multigrid);
}

TEST(ChooseMethod, FactorisesOnTheReferenceBackEndUnlessTold) {
    EXPECT_EQ(choose_method(with_columns(1), 3000000, host).method, LinearMethod::direct);
}

TEST(MakeLinearSolver, DescribesWhoSolvesAndWhy) {
    const Model model = fixtures::two_tissue_model({3, 3, 3});
    LinearSolverOptions options;
    options.backend = "reference";

    const LinearSolverInfo direct = make_linear_solver(model, options)->describe();
    options.method = LinearMethod::jacobi;
    const LinearSolverInfo jacobi = make_linear_solver(model, options)->describe();

    EXPECT_EQ(direct.method, LinearMethod::direct);
    EXPECT_EQ(direct.device.device, "host");
    EXPECT_FALSE(direct.library.empty());
    EXPECT_EQ(direct.reason, "the reference back end solves directly");
    EXPECT_EQ(jacobi.method, LinearMethod::jacobi);
    EXPECT_EQ(jacobi.device.backend, "reference");
    EXPECT_TRUE(jacobi.library.empty());
    EXPECT_EQ(jacobi.reason, "asked for");
}

TEST(MakeLinearSolver, TakesTheMethodThatIsAskedFor) {
    const Model model = fixtures::two_tissue_model({3, 3, 3});
    LinearSolverOptions options;
    options.backend = "reference";
    for (LinearMethod method :
         {LinearMethod::multigrid, LinearMethod::jacobi, LinearMethod::direct}) {
        options.method = method;
        EXPECT_EQ(make_linear_solver(model, options)->describe().method, method);
    }
}

}  // namespace
}  // namespace palpate
