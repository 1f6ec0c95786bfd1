// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/rest_solver.hpp"

#include <utility>

#include "solver/base/error.hpp"
#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/linear/direct_columns.hpp"
#include "solver/linear/make_linear_solver.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/tet4_model.hpp"

namespace palpate {
namespace {

/// K x = b by a factorisation on the host.
class RestSolver final : public LinearSolver {
public:
    RestSolver(const SolidModel& model, const LinearSolverOptions& options)
        : model_(model), system_(model), columns_(system_, options) {}

    LinearSolverInfo describe() const override {
        return columns_.describe(model_.mesh.table().name +
                                 " elements: factorised on the host; devices solve with tet4 only");
    }

    void set_stiffness(std::span<const double> stiffness_kpa) override {
        if (stiffness_kpa.size() != model_.materials.size())
            throw Error(ErrorCode::invalid_argument,
                        "The linear solver got " + std::to_string(stiffness_kpa.size()) +
                            " moduli for " + std::to_string(model_.materials.size()) +
                            " materials; give one per material.");
        for (std::size_t r = 0; r < stiffness_kpa.size(); ++r) {
            SolidMaterial& material = model_.materials[r];
            material.parameters =
                parameters_of_stiffness(material.law, material.parameters, stiffness_kpa[r]);
        }
        system_.set(stiffness_at_rest(model_));
        columns_.factorise();
    }

    LinearSolverSummary solve(const Columns& b, Columns& x, const ProgressSink& progress) override {
        return columns_.solve(b, x, progress);
    }

private:
    struct System : ConstrainedMatrix {
        explicit System(const SolidModel& model)
            : ConstrainedMatrix(stiffness_at_rest(model), model.prescribed) {}
        void set(StiffnessMatrix stiffness) { stiffness_ = std::move(stiffness); }
    };

    SolidModel model_;
    System system_;
    DirectColumns columns_;
};

}  // namespace

StiffnessMatrix stiffness_at_rest(const SolidModel& model) {
    if (is_linear_tet4(model)) {
        const Model linear = tet4_model_of(model);
        check_model(linear);
        return assemble_stiffness(linear);
    }
    const SolidAssembly solid(model);
    StiffnessMatrix stiffness;
    static_cast<BlockMatrix&>(stiffness) = solid.make_matrix();
    solid.tangent(Eigen::VectorXd::Zero(model.num_dofs()), stiffness);
    return stiffness;
}

std::unique_ptr<LinearSolver> make_rest_solver(const SolidModel& model,
                                               const LinearSolverOptions& options) {
    if (is_linear_tet4(model)) return make_linear_solver(tet4_model_of(model), options);
    if (options.method == LinearMethod::multigrid || options.method == LinearMethod::jacobi)
        throw Error(ErrorCode::unsupported, std::string("the linear solver '") +
                                                name_of(options.method) + "' takes tet4, not " +
                                                model.mesh.table().name +
                                                "; choose 'auto' or 'direct'");
    return std::make_unique<RestSolver>(model, options);
}

}  // namespace palpate
