// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/solver_figures.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/page/tree_json.hpp"

namespace palpate {
namespace {

TEST(SolverFigures, TellWhoSolvedAlikeInAllResults) {
    LinearSolverInfo solver{{}, LinearMethod::direct, "Eigen 3.4.0 LDLT", "asked for"};
    solver.device.backend = "reference";
    solver.device.device = "host";

    EXPECT_EQ(tree_json(solver_part("tangents", solver)),
              "{\n  \"method\": \"direct\",\n  \"library\": \"Eigen 3.4.0 LDLT\",\n"
              "  \"backend\": \"reference\",\n  \"device\": \"host\",\n"
              "  \"reason\": \"asked for\"\n}\n");
    EXPECT_EQ(solver_text(solver), "direct, Eigen 3.4.0 LDLT on host (asked for)");
    solver.library.clear();
    EXPECT_EQ(solver_text(solver), "direct on host (asked for)");
}

TEST(SolverFigures, SayWhereTheElementLoopsRan) {
    ElementLoopInfo loops{{}, "few elements"};
    loops.device.backend = "opencl";
    loops.device.device = "gpu";

    ResultTree tree;
    add_loops("loops", loops, tree);
    add_loops("none", std::nullopt, tree);
    add_solver("solver", std::nullopt, tree);

    EXPECT_EQ(nlohmann::json::parse(tree_json(tree)).dump(),
              R"({"loops":{"backend":"opencl","device":"gpu","reason":"few elements"},)"
              R"("none":null,"solver":null})");
    EXPECT_EQ(titled_rows(tree), (std::vector<std::pair<std::string, std::string>>{
                                     {"Element loops", "on gpu (few elements)"}}));
}

}  // namespace
}  // namespace palpate
