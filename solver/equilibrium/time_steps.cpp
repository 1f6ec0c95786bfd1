// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/time_steps.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// The histories of all points.
class ViscousHistory {
public:
    explicit ViscousHistory(const SolidAssembly& solid)
        : model_(solid.model()),
          points_(static_cast<std::size_t>(model_.mesh.table().num_points)),
          stress_(points_ * model_.mesh.region.size(), Tensor3<double>{}),
          terms_(stress_.size()) {
        for (std::size_t p = 0; p < terms_.size(); ++p)
            terms_[p].assign(relaxation_of(p).size(), Tensor3<double>{});
    }

    bool is_needed() const {
        return std::any_of(model_.materials.begin(), model_.materials.end(),
                           [](const auto& material) { return !material.relaxation.empty(); });
    }

    void begin_step(double dt_s, SolidAssembly& solid) const {
        std::vector<double> factor;
        for (const SolidMaterial& material : model_.materials) {
            factor.push_back(1);
            for (const RelaxationTerm& term : material.relaxation)
                factor.back() += part_of(term, dt_s);
        }
        std::vector<Tensor3<double>> prestress(stress_.size(), Tensor3<double>{});
        for (std::size_t p = 0; p < terms_.size(); ++p)
            for (std::size_t k = 0; k < terms_[p].size(); ++k) {
                const RelaxationTerm& term = relaxation_of(p)[k];
                const auto left = sum_of(std::exp(-dt_s / term.time_s), terms_[p][k],
                                         -part_of(term, dt_s), stress_[p]);
                prestress[p] = sum_of(1.0, prestress[p], 1.0, left);
            }
        solid.set_viscous_step(std::move(factor), std::move(prestress));
    }

    void end_step(double dt_s, const SolidAssembly& solid, const Eigen::VectorXd& u) {
        std::vector<Tensor3<double>> next = solid.elastic_stress(u);
        for (std::size_t p = 0; p < terms_.size(); ++p)
            for (std::size_t k = 0; k < terms_[p].size(); ++k) {
                const RelaxationTerm& term = relaxation_of(p)[k];
                const auto change = sum_of(1.0, next[p], -1.0, stress_[p]);
                terms_[p][k] = sum_of(std::exp(-dt_s / term.time_s), terms_[p][k],
                                      part_of(term, dt_s), change);
            }
        stress_ = std::move(next);
    }

private:
    /// c_k of a step.
    static double part_of(const RelaxationTerm& term, double dt_s) {
        const double x = dt_s / term.time_s;
        return term.amplitude * -std::expm1(-x) / x;
    }
    const std::vector<RelaxationTerm>& relaxation_of(std::size_t point) const {
        return model_.materials[model_.mesh.region[point / points_]].relaxation;
    }

    const SolidModel& model_;
    std::size_t points_;
    std::vector<Tensor3<double>> stress_;              ///< S at the last time, by point
    std::vector<std::vector<Tensor3<double>>> terms_;  ///< h_k, by point
};

void check_times(const std::vector<LoadTime>& times) {
    double before = 0;
    for (const LoadTime& at : times) {
        if (!(at.time_s > before) || !std::isfinite(at.time_s))
            throw Error(ErrorCode::invalid_argument,
                        "times of loads must ascend from above 0 s; there is " +
                            std::to_string(at.time_s) + " after " + std::to_string(before));
        before = at.time_s;
    }
}

}  // namespace

std::vector<Equilibrium> solve_history(const SolidModel& model, const std::vector<LoadTime>& times,
                                       const EquilibriumOptions& options,
                                       const ProgressSink& progress) {
    check_times(times);
    SolidAssembly solid(model);
    ViscousHistory history(solid);
    std::vector<Equilibrium> states;
    EquilibriumStart start;
    double now_s = 0;
    for (const LoadTime& at : times) {
        const double dt_s = at.time_s - now_s;
        if (history.is_needed()) history.begin_step(dt_s, solid);
        states.push_back(solve_equilibrium(solid, at.loads, options, start, progress));
        states.back().tangent.reset();  // the assembly ends with this function
        if (!states.back().converged) break;
        if (history.is_needed()) history.end_step(dt_s, solid, states.back().displacement);
        start = {states.back().displacement, at.loads.force, at.loads.obstacle_motion,
                 states.back().contact.friction};
        now_s = at.time_s;
    }
    return states;
}

}  // namespace palpate
