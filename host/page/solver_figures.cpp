// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/solver_figures.hpp"

#include <fmt/format.h>

#include <utility>

namespace palpate {

ResultTree solver_part(std::string name, const LinearSolverInfo& solver) {
    return ResultTree::of(std::move(name), {{"method", name_of(solver.method)},
                                            {"library", solver.library},
                                            {"backend", solver.device.backend},
                                            {"device", solver.device.device},
                                            {"reason", solver.reason}});
}

void add_solver(std::string name, const std::optional<LinearSolverInfo>& solver, ResultTree& tree) {
    if (solver)
        tree.add(solver_part(std::move(name), *solver));
    else
        tree.add(std::move(name), FigureValue());
}

void add_loops(std::string name, const std::optional<ElementLoopInfo>& loops, ResultTree& tree) {
    if (!loops) {
        tree.add(std::move(name), FigureValue());
        return;
    }
    ResultTree part = ResultTree::of(std::move(name), {{"backend", loops->device.backend},
                                                       {"device", loops->device.device},
                                                       {"reason", loops->reason}});
    part.add(Figure{.value = fmt::format("on {} ({})", loops->device.device, loops->reason),
                    .title = "Element loops"});
    tree.add(std::move(part));
}

std::string solver_text(const LinearSolverInfo& solver) {
    return fmt::format("{}{}{} on {} ({})", name_of(solver.method),
                       solver.library.empty() ? "" : ", ", solver.library, solver.device.device,
                       solver.reason);
}

}  // namespace palpate
