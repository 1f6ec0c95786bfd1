// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/condense/region_mechanics.hpp"

#include <utility>

#include "solver/equilibrium/rest_solver.hpp"
#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/linear/direct_columns.hpp"

namespace palpate {
namespace {

class RegionAtRest final : public RegionMechanics {
public:
    RegionAtRest(const SolidModel& part, const LinearSolverOptions& options)
        : stiffness_(stiffness_at_rest(part)), solver_(make_rest_solver(part, options)) {}

    const StiffnessMatrix& stiffness() const override { return stiffness_; }
    LinearSolverSummary solve(const Columns& b, Columns& x) override {
        return solver_->solve(b, x);
    }
    LinearSolverInfo describe() const override { return solver_->describe(); }

private:
    StiffnessMatrix stiffness_;
    std::unique_ptr<LinearSolver> solver_;
};

StiffnessMatrix tangent_of(const SolidModel& body, const Eigen::VectorXd& u,
                           const ElementLoopOptions& loops) {
    const SolidAssembly solid(body, loops);
    StiffnessMatrix tangent;
    static_cast<BlockMatrix&>(tangent) = solid.make_matrix();
    solid.tangent(u, tangent);
    return tangent;
}

class TangentMechanics final : public RegionMechanics {
public:
    TangentMechanics(StiffnessMatrix tangent, const SolidModel& body,
                     const LinearSolverOptions& options)
        : system_(std::move(tangent), body.prescribed), columns_(system_, options) {}

    const StiffnessMatrix& stiffness() const override { return system_.stiffness(); }
    LinearSolverSummary solve(const Columns& b, Columns& x) override {
        return columns_.solve(b, x, {});
    }
    LinearSolverInfo describe() const override {
        return columns_.describe("a new tangent for every state");
    }

private:
    ConstrainedMatrix system_;
    DirectColumns columns_;
};

}  // namespace

std::unique_ptr<RegionMechanics> make_region_at_rest(const SolidModel& part,
                                                     const LinearSolverOptions& options) {
    return std::make_unique<RegionAtRest>(part, options);
}

std::unique_ptr<RegionMechanics> make_tangent_mechanics(const SolidModel& body,
                                                        const Eigen::VectorXd& u,
                                                        const LinearSolverOptions& options) {
    const ElementLoopOptions loops{options.backend, options.device};
    return std::make_unique<TangentMechanics>(tangent_of(body, u, loops), body, options);
}

}  // namespace palpate
