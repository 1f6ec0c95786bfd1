// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/identify/tissue_of_data.hpp"
#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

enum class Mode { uniaxial, equibiaxial, shear };

/// The body is at rest until 0 s; histories go forward.
void check_ascending(const NumberTable& numbers, const std::vector<double>& time_s) {
    for (std::size_t row = 0; row < time_s.size(); ++row)
        if (time_s[row] < (row == 0 ? 0 : time_s[row - 1]))
            numbers.refuse_row(row, "times must ascend from 0 s, when the tissue is at rest");
}

/// The homogeneous deformation of one mode: F with the stretch, or shear, and what is free.
struct HomogeneousState {
    double stress_kpa = 0;  ///< nominal, P_11 or P_12
    double lateral = 1;     ///< stretch of the directions that are free of stress
};

Tensor3<double> gradient_of(Mode mode, double stretch, double lateral) {
    Tensor3<double> h{};
    if (mode == Mode::shear) {
        h.m[1] = stretch;
        return h;
    }
    h.m[0] = stretch - 1;
    h.m[4] = (mode == Mode::equibiaxial ? stretch : lateral) - 1;
    h.m[8] = lateral - 1;
    return h;
}

/// Newton's method on P_33(lateral) = 0.
template <class Law>
HomogeneousState homogeneous_state(const Law& law, Mode mode, double stretch) {
    constexpr int most_steps = 60;
    HomogeneousState found;
    if (mode == Mode::shear) {
        found.stress_kpa = law.stress(law.state(gradient_of(mode, stretch, 1))).m[1];
        return found;
    }
    found.lateral = mode == Mode::uniaxial ? 1 / std::sqrt(stretch) : 1 / (stretch * stretch);
    Tensor3<double> change{};
    change.m[8] = 1;
    if (mode == Mode::uniaxial) change.m[4] = 1;
    for (int step = 0; step < most_steps; ++step) {
        const auto state = law.state(gradient_of(mode, stretch, found.lateral));
        const Tensor3<double> stress = law.stress(state);
        const double slope = law.tangent_apply(state, change).m[8];
        const double move = -stress.m[8] / slope;
        found.stress_kpa = stress.m[0];
        if (!state.is_valid || !std::isfinite(move)) break;
        if (std::abs(move) < 1e-13) return found;
        found.lateral += std::max(move, -0.5 * found.lateral);
    }
    throw Error(ErrorCode::solve_failed,
                fmt::format("a stretch of {:g} has no state without lateral stress", stretch));
}

/// Nominal stress over stretch (or shear) of one piece of tissue that deforms alike everywhere, its
/// sides free. With times the isochoric stress relaxes,
///   S_1(t) = [a S](t) + l_3^2 / l_1^2 [(1 - a) S l_1^2 / l_3^2](t),   [f] = f + sum C h,
///   h(t) = int exp(-(t - s)/tau) df(s),
/// S = P_11 / l_1 the elastic stress, a = 2/3 (pulled one way) or 1/3 (two ways).
class StressStretchData final : public MeasuredData {
public:
    explicit StressStretchData(const DataSource& source) : tissue_(source.table) {
        const std::string mode =
            source.table.choice("mode", {"uniaxial", "equibiaxial", "shear"}).value_or("uniaxial");
        mode_ = mode == "shear"      ? Mode::shear
                : mode == "uniaxial" ? Mode::uniaxial
                                     : Mode::equibiaxial;
        read_stretch(source.numbers);
        gain_ = source.table.number("gain", {0, any_number.high, true}).value_or(1);
        block_.unit = "kPa";
        block_.measured = vector_of(source.numbers.values("stress_kpa"));
        block_.sd = read_sd(source, "sd_kpa");
        if (source.numbers.find("time_s")) {
            time_s_ = source.numbers.values("time_s");
            check_ascending(source.numbers, time_s_);
            block_.time_s = vector_of(time_s_);
        } else {
            block_.position_mm = vector_of(stretch_);  // nearby stretches err alike
        }
    }

    bool needs_simulation() const override { return false; }

    Eigen::VectorXd predicted(const ExperimentState& state) const override {
        const SolidMaterial& material = tissue_.material_in(state.materials);
        std::vector<HomogeneousState> states;
        with_material_law<double>(material.law, material.parameters, [&](const auto& law) {
            for (const double stretch : stretch_)
                states.push_back(homogeneous_state(law, mode_, stretch));
        });
        std::vector<double> stress;
        for (const HomogeneousState& one : states) stress.push_back(one.stress_kpa);
        if (!time_s_.empty() && !material.relaxation.empty()) stress = relaxed(states, material);
        return gain_ * long_term_part(material) * vector_of(stress);
    }

private:
    void read_stretch(const NumberTable& numbers) {
        stretch_ = numbers.values(mode_ == Mode::shear ? "shear" : "stretch");
        for (std::size_t row = 0; row < stretch_.size(); ++row)
            if (mode_ != Mode::shear && !(stretch_[row] > 0))
                numbers.refuse_row(row, "a stretch is not above 0; 1 is at rest");
        if (mode_ == Mode::shear && numbers.find("time_s"))
            throw Error(ErrorCode::unsupported,
                        numbers.source + ": relaxation in shear is not computed; leave time_s out");
    }

    /// [f](t) of values at the rows' times, at rest before the first.
    std::vector<double> convolved(const std::vector<double>& f,
                                  const std::vector<RelaxationTerm>& terms) const {
        std::vector<double> sum = f;
        for (const RelaxationTerm& term : terms) {
            double h = 0, before = 0, before_s = 0;
            for (std::size_t k = 0; k < f.size(); ++k) {
                const double q = (time_s_[k] - before_s) / term.time_s;
                const double part = q > 1e-9 ? -std::expm1(-q) / q : 1;
                h = std::exp(-q) * h + part * (f[k] - before);
                sum[k] += term.amplitude * h;
                before = f[k];
                before_s = time_s_[k];
            }
        }
        return sum;
    }

    std::vector<double> relaxed(const std::vector<HomogeneousState>& states,
                                const SolidMaterial& material) const {
        const std::vector<RelaxationTerm>& terms = material.relaxation;
        // Of all of S nothing is left across, so a = 1.
        const double own = material.relaxation_of == RelaxationOf::total ? 1.0
                           : mode_ == Mode::uniaxial                     ? 2.0 / 3
                                                                         : 1.0 / 3;
        std::vector<double> along, across, ratio;
        for (std::size_t k = 0; k < states.size(); ++k) {
            const double s = states[k].stress_kpa / stretch_[k];
            ratio.push_back(std::pow(stretch_[k] / states[k].lateral, 2));
            along.push_back(own * s);
            across.push_back((1 - own) * s * ratio[k]);
        }
        along = convolved(along, terms);
        across = convolved(across, terms);
        for (std::size_t k = 0; k < states.size(); ++k)
            along[k] = stretch_[k] * (along[k] + across[k] / ratio[k]);
        return along;
    }

    TissueOfData tissue_;
    Mode mode_ = Mode::uniaxial;
    double gain_ = 1;
    std::vector<double> stretch_, time_s_;
};

}  // namespace

DataKind stress_stretch_kind() {
    return {"stress-stretch",
            "Nominal stress of tissue that deforms alike everywhere: columns stretch (or shear), "
            "stress_kpa; time_s",
            {"material", "mode", "gain", "sd_kpa"},
            [](const DataSource& source) {
                return std::unique_ptr<MeasuredData>(new StressStretchData(source));
            }};
}

}  // namespace palpate
