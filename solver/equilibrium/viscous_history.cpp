// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/viscous_history.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// A term over a step: h' = kept h + part (S' - S), and how both change with amplitude and time.
struct TermStep {
    double kept, part;
    double part_by_amplitude, kept_by_time, part_by_time;

    TermStep(const RelaxationTerm& term, double dt_s) {
        // x = dt / tau, kept = exp(-x), part = C (1 - exp(-x)) / x (method.md, 9.6)
        const double x = dt_s / term.time_s;
        kept = std::exp(-x);
        part_by_amplitude = -std::expm1(-x) / x;
        part = term.amplitude * part_by_amplitude;
        // dx/dtau = -x / tau,  d kept/dx = -kept,  d((1 - e^-x) / x)/dx = (e^-x - (1 - e^-x) / x) /
        // x
        const double x_by_time = -x / term.time_s;
        kept_by_time = -kept * x_by_time;
        part_by_time = term.amplitude * (kept - part_by_amplitude) / x * x_by_time;
    }
};

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
      stress_(points_per_element_ * model.mesh.region.size(), Tensor3<double>{}),
      terms_(make_slopes().terms) {}

Index ViscousHistory::material_of(std::size_t point) const {
    return model_->mesh.region[point / points_per_element_];
}

const std::vector<RelaxationTerm>& ViscousHistory::relaxation_of(std::size_t point) const {
    return model_->materials[material_of(point)].relaxation;
}

HistorySlopes ViscousHistory::make_slopes() const {
    HistorySlopes slopes;
    slopes.stress.assign(stress_.size(), Tensor3<double>{});
    for (std::size_t p = 0; p < stress_.size(); ++p)
        slopes.terms.emplace_back(relaxation_of(p).size(), Tensor3<double>{});
    return slopes;
}

void ViscousHistory::begin_step(double dt_s, SolidAssembly& solid) const {
    std::vector<double> factor;
    for (const SolidMaterial& material : model_->materials) {
        factor.push_back(1);
        for (const RelaxationTerm& term : material.relaxation)
            // 1 + sum c_k (method.md, 9.7)
            factor.back() += TermStep(term, dt_s).part;
    }
    std::vector<Tensor3<double>> prestress(stress_.size(), Tensor3<double>{});
    for (std::size_t p = 0; p < terms_.size(); ++p)
        for (std::size_t k = 0; k < terms_[p].size(); ++k) {
            const TermStep step(relaxation_of(p)[k], dt_s);
            // Q = sum_k (exp(-x) h_k - c_k S_n): what of sum h_k' is known before the step
            add(prestress[p], step.kept, terms_[p][k]);
            add(prestress[p], -step.part, stress_[p]);
        }
    solid.set_viscous_step(std::move(factor), std::move(prestress));
}

void ViscousHistory::end_step(double dt_s, const SolidAssembly& solid, const Eigen::VectorXd& u) {
    std::vector<Tensor3<double>> next = solid.elastic_stress(u);
    for (std::size_t p = 0; p < terms_.size(); ++p)
        for (std::size_t k = 0; k < terms_[p].size(); ++k) {
            const TermStep step(relaxation_of(p)[k], dt_s);
            // h_k' = exp(-x) h_k + c_k (S' - S_n) (method.md, 9.6)
            const auto change = sum_of(1.0, next[p], -1.0, stress_[p]);
            terms_[p][k] = sum_of(step.kept, terms_[p][k], step.part, change);
        }
    stress_ = std::move(next);
}

std::vector<Tensor3<double>> ViscousHistory::stress_slope(double dt_s,
                                                          const HistorySlopes& after) const {
    std::vector<Tensor3<double>> slope = after.stress;
    for (std::size_t p = 0; p < terms_.size(); ++p)
        for (std::size_t k = 0; k < terms_[p].size(); ++k)
            // dJ/dS' = what the next step says of S' + sum_k c_k dJ/dh_k'
            add(slope[p], TermStep(relaxation_of(p)[k], dt_s).part, after.terms[p][k]);
    return slope;
}

HistorySlopes ViscousHistory::slopes_before(
    double dt_s, const HistorySlopes& after, const ViscousSlopes& step,
    const std::vector<Tensor3<double>>& stress,
    std::vector<std::vector<RelaxationTerm>>& relaxation) const {
    HistorySlopes before = make_slopes();
    for (std::size_t p = 0; p < terms_.size(); ++p)
        for (std::size_t k = 0; k < terms_[p].size(); ++k) {
            const TermStep term(relaxation_of(p)[k], dt_s);
            // h_k and S_n enter twice, in h_k' and in Q, as exp(-x) h_k - c_k S_n:
            //   dJ/dh_k = exp(-x) (dJ/dh_k' + dJ/dQ),   dJ/dS_n = -c_k (dJ/dh_k' + dJ/dQ).
            const auto on_both = sum_of(1.0, after.terms[p][k], 1.0, step.prestress[p]);
            add(before.terms[p][k], term.kept, on_both);
            add(before.stress[p], -term.part, on_both);
            // dJ/d exp(-x) and dJ/dc_k, then both by C_k and tau_k
            const double by_kept = double_dot(on_both, terms_[p][k]);
            const double by_part =
                double_dot(after.terms[p][k], stress[p]) - double_dot(on_both, stress_[p]);
            RelaxationTerm& sum = relaxation[material_of(p)][k];
            sum.amplitude += by_part * term.part_by_amplitude;
            sum.time_s += by_kept * term.kept_by_time + by_part * term.part_by_time;
        }
    for (std::size_t m = 0; m < model_->materials.size(); ++m)
        for (std::size_t k = 0; k < model_->materials[m].relaxation.size(); ++k) {
            const TermStep term(model_->materials[m].relaxation[k], dt_s);
            // c_k is in the factor 1 + sum c_k of the step as well.
            relaxation[m][k].amplitude += step.factor[m] * term.part_by_amplitude;
            relaxation[m][k].time_s += step.factor[m] * term.part_by_time;
        }
    return before;
}

}  // namespace palpate
