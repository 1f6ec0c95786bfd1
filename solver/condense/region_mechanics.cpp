// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/condense/region_mechanics.hpp"

#include <utility>

#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/linear/direct_columns.hpp"
#include "solver/linear/make_linear_solver.hpp"

namespace palpate {
namespace {

class LinearRegion final : public RegionMechanics {
public:
    LinearRegion(const Model& part, const LinearSolverOptions& options)
        : stiffness_(assemble_stiffness(part)), solver_(make_linear_solver(part, options)) {}

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

SolidModel solid_of(const Model& part, const std::string& law) {
    const LinearElastic& material = part.materials.front();
    return {solid_mesh_of(part.mesh),
            {{law, {material.stiffness_kpa, material.poisson_ratio}}},
            part.prescribed};
}

Tangent tangent_of(const Model& part, const std::string& law, const Eigen::VectorXd& u) {
    const SolidAssembly solid(solid_of(part, law));
    Tangent tangent;
    static_cast<BlockMatrix&>(tangent.stiffness) = solid.make_matrix();
    solid.tangent(u, tangent.stiffness);
    tangent.force = solid.internal_force(u).force;
    return tangent;
}

class TangentRegion final : public RegionMechanics {
public:
    TangentRegion(Tangent tangent, const Model& part, const LinearSolverOptions& options)
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

std::unique_ptr<RegionMechanics> make_linear_region(const Model& part,
                                                    const LinearSolverOptions& options) {
    return std::make_unique<LinearRegion>(part, options);
}

std::unique_ptr<RegionMechanics> make_tangent_region(const Model& part, const std::string& law,
                                                     const Eigen::VectorXd& u,
                                                     const LinearSolverOptions& options) {
    return std::make_unique<TangentRegion>(tangent_of(part, law, u), part, options);
}

Eigen::VectorXd force_of_region(const Model& part, const std::string& law,
                                const Eigen::VectorXd& u) {
    return SolidAssembly(solid_of(part, law)).internal_force(u).force;
}

}  // namespace palpate
