// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/viscous_history.hpp"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

void add(Tensor3<double>& sum, double factor, const Tensor3<double>& term) {
    sum = sum_of(1.0, sum, factor, term);
}

}  // namespace

bool has_relaxation(const SolidModel& model) {
    return std::any_of(model.materials.begin(), model.materials.end(),
                       [](const SolidMaterial& material) { return !material.relaxation.empty(); });
}

ViscousHistory::ViscousHistory(const SolidModel& model)
    : model_(&model),
      points_per_element_(static_cast<std::size_t>(model.mesh.table().num_points)),
      now_(make_tensors()) {}

Index ViscousHistory::material_of(std::size_t point) const {
    return model_->mesh.region[point / points_per_element_];
}

HistoryTensors ViscousHistory::make_tensors() const {
    HistoryTensors tensors;
    tensors.stress.assign(points_per_element_ * model_->mesh.region.size(), Tensor3<double>{});
    for (std::size_t p = 0; p < tensors.stress.size(); ++p)
        tensors.terms.emplace_back(model_->materials[material_of(p)].relaxation.size(),
                                   Tensor3<double>{});
    return tensors;
}

std::vector<RelaxationStep> ViscousHistory::steps(double dt_s) const {
    std::vector<RelaxationStep> steps;
    for (const SolidMaterial& material : model_->materials)
        steps.push_back(relaxation_step(material, dt_s));
    return steps;
}

std::vector<RelaxationStep> ViscousHistory::step_changes(double dt_s,
                                                         const RelaxationChange& change) const {
    std::vector<RelaxationStep> steps;
    for (std::size_t m = 0; m < model_->materials.size(); ++m) {
        std::span<const RelaxationTerm> terms;
        if (!change.terms.empty()) terms = change.terms[m];
        steps.push_back(relaxation_step_change(model_->materials[m], dt_s, terms, change.dt_s));
    }
    return steps;
}

void ViscousHistory::begin_step(double dt_s, SolidAssembly& solid) const {
    const std::vector<RelaxationStep> by_material = steps(dt_s);
    std::vector<double> factor;
    // g + sum c_k (method.md, 9.7)
    for (const RelaxationStep& step : by_material) factor.push_back(step.factor);
    std::vector<Tensor3<double>> prestress(now_.stress.size(), Tensor3<double>{});
    for (std::size_t p = 0; p < prestress.size(); ++p) {
        const RelaxationStep& step = by_material[material_of(p)];
        for (std::size_t k = 0; k < step.terms.size(); ++k) {
            // Q = sum_k (exp(-x) h_k - c_k S_n): what of sum h_k' is known before the step
            add(prestress[p], step.terms[k].kept, now_.terms[p][k]);
            add(prestress[p], -step.terms[k].part, now_.stress[p]);
        }
    }
    solid.set_viscous_step(std::move(factor), std::move(prestress));
}

void ViscousHistory::end_step(double dt_s, std::vector<Tensor3<double>> stress) {
    const std::vector<RelaxationStep> by_material = steps(dt_s);
    for (std::size_t p = 0; p < stress.size(); ++p) {
        const RelaxationStep& step = by_material[material_of(p)];
        // h_k' = exp(-x) h_k + c_k (S' - S_n) (method.md, 9.6)
        const auto change = sum_of(1.0, stress[p], -1.0, now_.stress[p]);
        for (std::size_t k = 0; k < step.terms.size(); ++k)
            now_.terms[p][k] =
                sum_of(step.terms[k].kept, now_.terms[p][k], step.terms[k].part, change);
    }
    now_.stress = std::move(stress);
}

std::vector<Tensor3<double>> ViscousHistory::stress_slope(double dt_s,
                                                          const HistoryTensors& after) const {
    const std::vector<RelaxationStep> by_material = steps(dt_s);
    std::vector<Tensor3<double>> slope = after.stress;
    for (std::size_t p = 0; p < slope.size(); ++p) {
        const RelaxationStep& step = by_material[material_of(p)];
        for (std::size_t k = 0; k < step.terms.size(); ++k)
            // dJ/dS' = what the next step says of S' + sum_k c_k dJ/dh_k'
            add(slope[p], step.terms[k].part, after.terms[p][k]);
    }
    return slope;
}

HistoryTensors ViscousHistory::slopes_before(
    double dt_s, const HistoryTensors& after, const ViscousSlopes& step,
    const std::vector<Tensor3<double>>& stress,
    std::vector<std::vector<RelaxationTerm>>& relaxation) const {
    const std::vector<RelaxationStep> by_material = steps(dt_s);
    HistoryTensors before = make_tensors();
    std::vector<RelaxationStep> slopes;  // of J by the step of each material
    for (std::size_t m = 0; m < by_material.size(); ++m)
        // c_k is in the factor g + sum c_k of the step as well.
        slopes.push_back(
            {step.factor[m], std::vector<RelaxationStep::Term>(by_material[m].terms.size())});
    for (std::size_t p = 0; p < now_.stress.size(); ++p) {
        const RelaxationStep& of_point = by_material[material_of(p)];
        for (std::size_t k = 0; k < of_point.terms.size(); ++k) {
            const RelaxationStep::Term& term = of_point.terms[k];
            // h_k and S_n enter twice, in h_k' and in Q, as exp(-x) h_k - c_k S_n:
            //   dJ/dh_k = exp(-x) (dJ/dh_k' + dJ/dQ),   dJ/dS_n = -c_k (dJ/dh_k' + dJ/dQ).
            const auto on_both = sum_of(1.0, after.terms[p][k], 1.0, step.prestress[p]);
            add(before.terms[p][k], term.kept, on_both);
            add(before.stress[p], -term.part, on_both);
            // dJ/d exp(-x) and dJ/dc_k
            RelaxationStep::Term& sum = slopes[material_of(p)].terms[k];
            sum.kept += double_dot(on_both, now_.terms[p][k]);
            sum.part +=
                double_dot(after.terms[p][k], stress[p]) - double_dot(on_both, now_.stress[p]);
        }
    }
    for (std::size_t m = 0; m < slopes.size(); ++m)
        add_term_slopes(model_->materials[m], dt_s, slopes[m], relaxation[m]);
    return before;
}

SolidChange ViscousHistory::begin_change(double dt_s, const HistoryTensors& before,
                                         const RelaxationChange& change) const {
    const std::vector<RelaxationStep> by_material = steps(dt_s);
    const std::vector<RelaxationStep> changes = step_changes(dt_s, change);
    SolidChange result;
    for (const RelaxationStep& step : changes) result.factor.push_back(step.factor);
    result.prestress.assign(now_.stress.size(), Tensor3<double>{});
    for (std::size_t p = 0; p < now_.stress.size(); ++p)
        for (std::size_t k = 0; k < now_.terms[p].size(); ++k) {
            const RelaxationStep::Term& step = by_material[material_of(p)].terms[k];
            const RelaxationStep::Term& by = changes[material_of(p)].terms[k];
            // dQ = sum_k (d exp(-x) h_k + exp(-x) dh_k - dc_k S_n - c_k dS_n)
            add(result.prestress[p], by.kept, now_.terms[p][k]);
            add(result.prestress[p], step.kept, before.terms[p][k]);
            add(result.prestress[p], -by.part, now_.stress[p]);
            add(result.prestress[p], -step.part, before.stress[p]);
        }
    return result;
}

HistoryTensors ViscousHistory::end_change(double dt_s, const HistoryTensors& before,
                                          const std::vector<Tensor3<double>>& stress,
                                          std::vector<Tensor3<double>> stress_change,
                                          const RelaxationChange& change) const {
    const std::vector<RelaxationStep> by_material = steps(dt_s);
    const std::vector<RelaxationStep> changes = step_changes(dt_s, change);
    HistoryTensors after = make_tensors();
    for (std::size_t p = 0; p < stress.size(); ++p) {
        const auto rise = sum_of(1.0, stress[p], -1.0, now_.stress[p]);
        const auto rise_change = sum_of(1.0, stress_change[p], -1.0, before.stress[p]);
        for (std::size_t k = 0; k < now_.terms[p].size(); ++k) {
            const RelaxationStep::Term& step = by_material[material_of(p)].terms[k];
            const RelaxationStep::Term& by = changes[material_of(p)].terms[k];
            // dh_k' = d exp(-x) h_k + exp(-x) dh_k + dc_k (S' - S_n) + c_k (dS' - dS_n)
            add(after.terms[p][k], by.kept, now_.terms[p][k]);
            add(after.terms[p][k], step.kept, before.terms[p][k]);
            add(after.terms[p][k], by.part, rise);
            add(after.terms[p][k], step.part, rise_change);
        }
    }
    after.stress = std::move(stress_change);
    return after;
}

}  // namespace palpate
