// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/identify/tissue_of_data.hpp"

namespace palpate {
namespace {

/// The force of a held deformation, falling: gain (1 + sum C exp(-(t - t_0)/tau)).
class RelaxationData final : public MeasuredData {
public:
    explicit RelaxationData(const DataSource& source)
        : tissue_(source.table),
          gain_(source.table.number("gain", {0, any_number.high, true}).value_or(1)),
          begin_s_(source.table.number("begin_s", any_number).value_or(0)),
          time_s_(source.numbers.values("time_s")) {
        block_.unit = source.table.text("unit").value_or("mN");
        block_.measured =
            vector_of(source.numbers.values(source.table.text("column").value_or("force_mn")));
        block_.sd = read_sd(source, "sd");
        block_.time_s = vector_of(time_s_);
        for (std::size_t row = 0; row < time_s_.size(); ++row)
            if (time_s_[row] < begin_s_)
                source.numbers.refuse_row(row,
                                          "a time is before begin_s, from which on the "
                                          "deformation is held");
    }

    bool needs_simulation() const override { return false; }

    Eigen::VectorXd predicted(const ExperimentState& state) const override {
        const SolidMaterial& material = tissue_.material_in(state.materials);
        Eigen::VectorXd rows(block_.num_row());
        for (std::size_t k = 0; k < time_s_.size(); ++k) {
            double factor = 1;
            for (const RelaxationTerm& term : material.relaxation)
                factor += term.amplitude * std::exp(-(time_s_[k] - begin_s_) / term.time_s);
            rows[Eigen::Index(k)] = gain_ * long_term_part(material) * factor;
        }
        return rows;
    }

private:
    TissueOfData tissue_;
    double gain_ = 1, begin_s_ = 0;
    std::vector<double> time_s_;
};

}  // namespace

DataKind relaxation_kind() {
    return {"relaxation",
            "Force of a deformation that is held from begin_s on, in any unit: columns time_s, "
            "force_mn",
            {"material", "column", "unit", "gain", "begin_s", "sd"},
            [](const DataSource& source) {
                return std::unique_ptr<MeasuredData>(new RelaxationData(source));
            }};
}

}  // namespace palpate
