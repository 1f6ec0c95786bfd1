// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/signal_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/identify/mesh_probe.hpp"
#include "host/apps/simulate/setting_values.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Resultant of a support or an obstacle on the body.
class ForceData final : public SignalData {
public:
    explicit ForceData(const DataSource& source)
        : SignalData(source, "force_mn", "sd_mn", "mN"),
          table_(source.table),
          component_(read_component(source.table)) {
        const auto on = source.table.text("on");
        if (!on) source.table.missing("on", "the name of a support or an obstacle");
        on_ = *on;
    }

private:
    std::vector<double> series(const SimulationResult& simulation) const override {
        const std::size_t holder = holder_of(simulation);
        std::vector<double> force;
        for (const SimulationState& state : simulation.states)
            force.push_back(state.force_mn[holder][component_]);
        return force;
    }

    std::size_t holder_of(const SimulationResult& simulation) const {
        std::vector<std::string> names;
        for (std::size_t k = 0; k < simulation.num_holders(); ++k) {
            if (simulation.holder_name(k) == on_) return k;
            names.push_back(simulation.holder_name(k));
        }
        table_.refuse("on",
                      fmt::format("allowed: what holds the body: {}", fmt::join(names, ", ")));
    }

    SettingsTable table_;
    std::string on_;
    int component_ = 0;
};

/// How far one place of the body moved.
class DisplacementData final : public SignalData {
public:
    explicit DisplacementData(const DataSource& source)
        : SignalData(source, "displacement_mm", "sd_mm", "mm"),
          table_(source.table),
          place_(needed_vector(source.table, "at_mm")),
          component_(read_component(source.table)) {}

private:
    std::vector<double> series(const SimulationResult& simulation) const override {
        const auto found = MeshProbe(simulation.mesh()).find(place_);
        if (!found) table_.refuse("at_mm", "allowed: a place in the body at rest");
        std::vector<double> moved;
        for (const SimulationState& state : simulation.states)
            moved.push_back(found->displacement(state.displacement)[component_]);
        return moved;
    }

    SettingsTable table_;
    Vec3 place_;
    int component_ = 0;
};

const std::vector<std::string_view> signal_keys(std::vector<std::string_view> own) {
    for (const std::string_view key : {"column", "gain", "delay_s", "component"})
        own.push_back(key);
    return own;
}

}  // namespace

MeasuredTimes::MeasuredTimes(const NumberTable& numbers) : num_row_(numbers.rows.size()) {
    if (!numbers.find("time_s")) return;
    time_s_ = numbers.values("time_s");
    for (std::size_t row = 0; row < time_s_.size(); ++row)
        if (time_s_[row] < 0) numbers.refuse_row(row, "a time is before 0 s, when the load begins");
}

MeasuredTimes::Between MeasuredTimes::at(const SimulationResult& simulation, std::size_t row,
                                         double delay_s) const {
    const std::vector<SimulationState>& states = simulation.states;
    const bool is_whole = simulation.converged();
    if (!are_given() && !is_whole)
        throw Error(ErrorCode::solve_failed, simulation.steps.back().message);
    if (!are_given()) return {states.size() - 1, states.size() - 1, 0};
    const double end_s = simulation.prepared.is_static ? 1 : simulation.prepared.time_s.back();
    const double time_s = std::max(0.0, time_s_[row] - delay_s);
    if (time_s > end_s * (1 + 1e-9) + std::max(0.0, -delay_s))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("a measurement is at {:g} s, but the loads end at {:g} s; give "
                                "loads for the whole time",
                                time_s_[row], end_s));
    const auto after = std::lower_bound(
        states.begin(), states.end(), time_s,
        [](const SimulationState& state, double time) { return state.time_s < time; });
    if (after == states.end()) {
        if (!is_whole) throw Error(ErrorCode::solve_failed, simulation.steps.back().message);
        return {states.size() - 1, states.size() - 1, 0};
    }
    const std::size_t k = static_cast<std::size_t>(after - states.begin());
    if (k == 0) return {0, 0, 0};
    const double before_s = states[k - 1].time_s;
    return {k - 1, k, (time_s - before_s) / (states[k].time_s - before_s)};
}

SignalData::SignalData(const DataSource& source, const std::string& column,
                       const std::string& sd_key, const std::string& unit)
    : times_(source.numbers),
      gain_(source.table.number("gain", positive).value_or(1)),
      delay_s_(source.table.number("delay_s", any_number).value_or(0)) {
    block_.unit = unit;
    block_.measured =
        vector_of(source.numbers.values(source.table.text("column").value_or(column)));
    block_.sd = read_sd(source, sd_key);
    if (times_.are_given()) block_.time_s = vector_of(times_.time_s());
}

Eigen::VectorXd SignalData::predicted(const ExperimentState& state) const {
    if (!times_.are_given() && times_.num_row() > 1 && !state.simulation->prepared.is_static)
        throw Error(ErrorCode::input_unreadable,
                    block_.name +
                        ": the file has several rows, but no column 'time_s', and the "
                        "loads have a [history]; say when each was measured");
    const std::vector<double> values = series(*state.simulation);
    Eigen::VectorXd rows(block_.num_row());
    for (std::size_t row = 0; row < times_.num_row(); ++row) {
        const auto [before, after, share] = times_.at(*state.simulation, row, delay_s_);
        rows[Eigen::Index(row)] =
            gain_ * (values[before] + share * (values[after] - values[before]));
    }
    return rows;
}

int read_component(const SettingsTable& table) {
    const auto component = table.choice("component", {"x", "y", "z"});
    if (!component) table.missing("component", "\"x\", \"y\" or \"z\"");
    return component->front() - 'x';
}

DataKind force_kind() {
    return {"force", "Force of a support or an obstacle on the body: columns time_s, force_mn",
            signal_keys({"on", "sd_mn"}), [](const DataSource& source) {
                return std::unique_ptr<MeasuredData>(new ForceData(source));
            }};
}

DataKind displacement_kind() {
    return {"displacement", "How far one place of the body moved: columns time_s, displacement_mm",
            signal_keys({"at_mm", "sd_mm"}), [](const DataSource& source) {
                return std::unique_ptr<MeasuredData>(new DisplacementData(source));
            }};
}

}  // namespace palpate
