// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/equilibrium/relaxation_step.hpp"
#include "solver/equilibrium/solid_assembly.hpp"

namespace palpate {

/// Whether any material has relaxation terms.
bool has_relaxation(const SolidModel& model);

/// One tensor for each that a ViscousHistory holds: those, or slopes of a scalar by them.
struct HistoryTensors {
    std::vector<Tensor3<double>> stress;              ///< S, [points] kPa
    std::vector<std::vector<Tensor3<double>>> terms;  ///< h_k, [points][terms] kPa
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
    void end_step(double dt_s, const SolidAssembly& solid, const Eigen::VectorXd& u);

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

private:
    Index material_of(std::size_t point) const;
    /// [materials]
    std::vector<RelaxationStep> steps(double dt_s) const;

    const SolidModel* model_;
    std::size_t points_per_element_;
    HistoryTensors now_;
};

}  // namespace palpate
