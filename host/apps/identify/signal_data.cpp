// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/signal_data.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/apps/simulate/setting_values.hpp"
#include "solver/base/error.hpp"

namespace palpate {
MeasuredTimes::MeasuredTimes(const NumberTable& numbers, double earliest_s)
    : num_row_(numbers.rows.size()) {
    if (!numbers.find("time_s")) return;
    time_s_ = numbers.values("time_s");
    for (std::size_t row = 0; row < time_s_.size(); ++row)
        if (time_s_[row] < earliest_s)
            numbers.refuse_row(row, "a time is before 0 s, when the load begins");
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

std::vector<std::string_view> signal_keys(std::vector<std::string_view> own) {
    for (const std::string_view key : {"column", "gain", "delay_s", "component"})
        own.push_back(key);
    return own;
}

}  // namespace palpate
