// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/identify/signal_data.hpp"
#include "host/apps/simulate/selection.hpp"
#include "host/apps/simulate/setting_values.hpp"
#include "host/apps/simulate/surface_profile.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// The height z(r, t) of a deformed surface, at fixed distances r from the axis: in a plane or
/// axisymmetric model x of the deformed place is r, y is z. Lengths that an instrument tells with
/// errors of scale, later than the loads:
///   z_measured(r, t) = z_scale z(r / r_scale, t - delay).
/// Where the model's surface at rest was itself measured with them (rest = "measured"), only the
/// change is scaled:
///   z_measured(r, t) = z(r, 0) + z_scale (z(r / r_scale, t - delay) - z(r / r_scale, 0)).
/// About an axis a place left of it, r < 0, is that at -r. A camera that is turned a little adds
/// tilt r; where r counts from `r_offset_mm` beside the axis, r - r_offset_mm stands for r in the
/// model. Where the surface at rest was guessed, its points are higher than in the model by what
/// `rest_error` says of their r at rest, at all times: straight lines between its places, and none
/// beyond them. What that changes of the mechanics is left out.
class ProfileData final : public MeasuredData {
public:
    explicit ProfileData(const DataSource& source)
        : table_(source.table),
          rest_is_measured_(source.table.choice("rest", {"modelled", "measured"}) == "measured"),
          times_(source.numbers, rest_is_measured_ ? any_number.low : 0),
          r_mm_(source.numbers.values("r_mm")),
          r_scale_(source.table.number("r_scale", positive).value_or(1)),
          z_scale_(source.table.number("z_scale", positive).value_or(1)),
          delay_s_(source.table.number("delay_s", any_number).value_or(0)),
          tilt_(source.table.number("tilt", any_number).value_or(0)),
          r_offset_mm_(source.table.number("r_offset_mm", any_number).value_or(0)) {
        read_rest_error(source.table);
        const auto where = source.table.table("where");
        if (!where) source.table.missing("where", "where = {side = \"y-max\"}, for example");
        surface_ = read_selection(*where);
        block_.unit = "mm";
        block_.measured = vector_of(source.numbers.values("z_mm"));
        block_.sd = read_sd(source, "sd_mm");
        block_.position_mm = vector_of(r_mm_);
        if (times_.are_given()) block_.time_s = vector_of(times_.time_s());
    }

    Eigen::VectorXd predicted(const ExperimentState& state) const override {
        const SimulationResult& simulation = *state.simulation;
        const std::vector<Index> nodes = surface_nodes(simulation);
        std::vector<std::optional<SurfaceProfile>> profiles(simulation.states.size());
        const bool is_about_axis = simulation.mesh().formulation == Formulation::axisymmetric;
        const auto place = [&](double r_mm) {
            const double r = r_mm - r_offset_mm_;
            return is_about_axis ? std::abs(r) : r;
        };
        double farthest_mm = 0;
        for (const double r : r_mm_)
            farthest_mm = std::max(farthest_mm, place(r) * std::max(1.0, 1 / r_scale_));
        Eigen::VectorXd rows(block_.num_row());
        for (std::size_t row = 0; row < r_mm_.size(); ++row) {
            const auto [before, after, share] = times_.at(simulation, row, delay_s_);
            const double r = place(r_mm_[row]);
            const auto height = [&](std::size_t k, double at_r) {
                if (!profiles[k]) profiles[k] = surface_profile(simulation, nodes, k, farthest_mm);
                return profiles[k]->height.at(at_r) + rest_error_at(profiles[k]->rest_x.at(at_r));
            };
            const auto z_at = [&](std::size_t k) { return z_scale_ * height(k, r / r_scale_); };
            const double first = z_at(before);
            double z = first + (after == before ? 0 : share * (z_at(after) - first));
            if (rest_is_measured_) {
                const double scaled = z_at(0);
                z += height(0, r) - scaled;
            }
            rows[Eigen::Index(row)] = z + tilt_ * r_mm_[row];
        }
        return rows;
    }

private:
    void read_rest_error(const SettingsTable& table) {
        for (const SettingsTable& place : table.tables("rest_error")) {
            place.allow_keys({"r_mm", "z_mm"});
            const auto r_mm = place.number("r_mm", any_number),
                       z_mm = place.number("z_mm", any_number);
            if (!r_mm) place.missing("r_mm", "a number");
            if (!z_mm) place.missing("z_mm", "a number, or {value = 0, sd = 0.2}");
            if (!error_r_mm_.empty() && !(*r_mm > error_r_mm_.back()))
                place.refuse("r_mm", "allowed: places that ascend");
            error_r_mm_.push_back(*r_mm);
            error_z_mm_.push_back(*z_mm);
        }
    }

    double rest_error_at(double r_mm) const {
        for (std::size_t k = 1; k < error_r_mm_.size(); ++k) {
            const double low = error_r_mm_[k - 1], high = error_r_mm_[k];
            if (r_mm < low || r_mm > high) continue;
            const double share = (r_mm - low) / (high - low);
            return error_z_mm_[k - 1] + share * (error_z_mm_[k] - error_z_mm_[k - 1]);
        }
        return 0;
    }

    /// Ascending along x at rest.
    std::vector<Index> surface_nodes(const SimulationResult& simulation) const {
        if (simulation.mesh().formulation == Formulation::solid)
            table_.fail("a profile is measured on a plane or axisymmetric body");
        std::vector<Index> nodes = nodes_along(surface_, simulation);
        if (nodes.size() < 3) table_.refuse("where", "allowed: a surface of at least three nodes");
        return nodes;
    }

    SettingsTable table_;
    bool rest_is_measured_ = false;
    MeasuredTimes times_;
    std::vector<double> r_mm_;
    double r_scale_ = 1, z_scale_ = 1, delay_s_ = 0, tilt_ = 0, r_offset_mm_ = 0;
    std::vector<double> error_r_mm_, error_z_mm_;
    Selection surface_;
};

}  // namespace

DataKind profile_kind() {
    return {"profile",
            "Height of a surface of a plane or axisymmetric body: columns time_s, r_mm, z_mm",
            {"where", "sd_mm", "r_scale", "z_scale", "delay_s", "rest", "tilt", "r_offset_mm",
             "rest_error"},
            [](const DataSource& source) {
                return std::unique_ptr<MeasuredData>(new ProfileData(source));
            }};
}

}  // namespace palpate
