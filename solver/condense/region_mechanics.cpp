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
    const Eigen::VectorXd& force() const override { return force_; }

private:
    StiffnessMatrix stiffness_;
    std::unique_ptr<LinearSolver> solver_;
    Eigen::VectorXd force_;
};

/// Stiffness and forces of one region at one displacement.
struct Tangent {
    StiffnessMatrix stiffness;
    Eigen::VectorXd force;
};

Tangent tangent_of(const SolidModel& part, const Eigen::VectorXd& u,
                   const ElementLoopOptions& loops) {
    const SolidAssembly solid(part, loops);
    Tangent tangent;
    static_cast<BlockMatrix&>(tangent.stiffness) = solid.make_matrix();
    solid.tangent(u, tangent.stiffness);
    tangent.force = solid.internal_force(u).force;
    return tangent;
}

class TangentRegion final : public RegionMechanics {
public:
    TangentRegion(Tangent tangent, const SolidModel& part, const LinearSolverOptions& options)
        : system_(std::move(tangent.stiffness), part.prescribed),
          columns_(system_, options),
          force_(std::move(tangent.force)) {}

    const StiffnessMatrix& stiffness() const override { return system_.stiffness(); }
    LinearSolverSummary solve(const Columns& b, Columns& x) override {
        return columns_.solve(b, x, {});
    }
    LinearSolverInfo describe() const override {
        return columns_.describe("a new tangent for every state");
    }
    const Eigen::VectorXd& force() const override { return force_; }

private:
    ConstrainedMatrix system_;
    DirectColumns columns_;
    Eigen::VectorXd force_;
};

}  // namespace

std::unique_ptr<RegionMechanics> make_region_at_rest(const SolidModel& part,
                                                     const LinearSolverOptions& options) {
    return std::make_unique<RegionAtRest>(part, options);
}

std::unique_ptr<RegionMechanics> make_tangent_region(const SolidModel& part,
                                                     const Eigen::VectorXd& u,
                                                     const LinearSolverOptions& options) {
    const ElementLoopOptions loops{options.backend, options.device};
    return std::make_unique<TangentRegion>(tangent_of(part, u, loops), part, options);
}

Eigen::VectorXd force_of_region(const SolidModel& part, const Eigen::VectorXd& u) {
    return SolidAssembly(part).internal_force(u).force;
}

}  // namespace palpate
