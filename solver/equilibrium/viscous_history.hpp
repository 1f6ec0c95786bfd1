// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/equilibrium/relaxation_step.hpp"
#include "solver/equilibrium/solid_assembly.hpp"

namespace palpate {

/// Whether any material has relaxation terms.
bool has_relaxation(const SolidModel& model);

/// One tensor for each that a ViscousHistory holds: those, slopes of a scalar by them, or how they
/// change.
struct HistoryTensors {
    std::vector<Tensor3<double>> stress;              ///< S, [points] kPa
    std::vector<std::vector<Tensor3<double>>> terms;  ///< h_k, [points][terms] kPa
};

/// How relaxation changes with one parameter, per unit of it.
struct RelaxationChange {
    std::vector<std::vector<RelaxationTerm>> terms;  ///< [materials][terms]; empty: none
    double dt_s = 0;                                 ///< of the length of the step
};

/// What the quadrature points of all elements remember of a load history (see `solve_history`): the
/// stress S that relaxes (`RelaxationOf`) as the law alone has it at the last time, and one history
/// h_k per term; at rest at first. Points of a material without relaxation remember nothing.
class ViscousHistory {
public:
    /// `model` must outlive this object.
    explicit ViscousHistory(const SolidModel& model);

    /// Makes `solid` answer as a step of dt_s from here does.
    void begin_step(double dt_s, SolidAssembly& solid) const;
    /// The step has led to u [3 num_nodes] mm.
    void end_step(double dt_s, const SolidAssembly& solid, const Eigen::VectorXd& u) {
        end_step(dt_s, solid.relaxing_stress(u));
    }
    /// It has led to these stresses that relax, `SolidAssembly::relaxing_stress`.
    void end_step(double dt_s, std::vector<Tensor3<double>> stress);

    /// S, [points].
    const std::vector<Tensor3<double>>& stress() const { return now_.stress; }

    /// All zeros.
    HistoryTensors make_tensors() const;
    /// Slopes by S at the end of the step, those by h_k handed on: [points].
    std::vector<Tensor3<double>> stress_slope(double dt_s, const HistoryTensors& after) const;
    /// From slopes at the end of a step that began here, and those by what the step was made of,
    /// to slopes at its beginning.
    ///   stress      S at the end, [points]
    ///   relaxation  receives the sum of slopes by amplitude and time, [materials][terms]
    HistoryTensors slopes_before(double dt_s, const HistoryTensors& after,
                                 const ViscousSlopes& step,
                                 const std::vector<Tensor3<double>>& stress,
                                 std::vector<std::vector<RelaxationTerm>>& relaxation) const;

    /// From how what is remembered here changes to how the factors and Q of a step do; parameters
    /// of laws are not touched.
    SolidChange begin_change(double dt_s, const HistoryTensors& before,
                             const RelaxationChange& change) const;
    /// The same to what is remembered at the end of the step.
    ///   stress         S at the end, [points]
    ///   stress_change  how that changes
    HistoryTensors end_change(double dt_s, const HistoryTensors& before,
                              const std::vector<Tensor3<double>>& stress,
                              std::vector<Tensor3<double>> stress_change,
                              const RelaxationChange& change) const;

private:
    Index material_of(std::size_t point) const;
    /// [materials]
    std::vector<RelaxationStep> steps(double dt_s) const;
    std::vector<RelaxationStep> step_changes(double dt_s, const RelaxationChange& change) const;

    const SolidModel* model_;
    std::size_t points_per_element_;
    HistoryTensors now_;
};

}  // namespace palpate
