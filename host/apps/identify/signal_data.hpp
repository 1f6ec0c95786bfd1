// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/identify/measured_data.hpp"

namespace palpate {

/// When rows were measured. Without a column `time_s` they are of the end of the load.
class MeasuredTimes {
public:
    /// `earliest_s`: 0, or less where what is before the load tells something, too.
    explicit MeasuredTimes(const NumberTable& numbers, double earliest_s = 0);

    bool are_given() const { return !time_s_.empty(); }
    const std::vector<double>& time_s() const { return time_s_; }
    std::size_t num_row() const { return num_row_; }

    /// The states before and after the time `delay_s` earlier, and how far it is between them.
    struct Between {
        std::size_t before = 0, after = 0;
        double share = 0;
    };
    /// Throws Error(solve_failed) if the simulation did not come so far, Error(invalid_argument) if
    /// it was not meant to.
    Between at(const SimulationResult& simulation, std::size_t row, double delay_s) const;

private:
    std::vector<double> time_s_;
    std::size_t num_row_ = 0;
};

/// One number over time: predicted = gain * series(t - delay).
class SignalData : public MeasuredData {
public:
    Eigen::VectorXd predicted(const ExperimentState& state) const final;

protected:
    /// `unit` "mN": reads the columns `column` (or what [[data]] calls `column`) and `sd_key`.
    SignalData(const DataSource& source, const std::string& column, const std::string& sd_key,
               const std::string& unit);
    /// The number in each state of the simulation.
    virtual std::vector<double> series(const SimulationResult& simulation) const = 0;

private:
    MeasuredTimes times_;
    double gain_ = 1, delay_s_ = 0;
};

/// The keys of a signal beside `own` ones.
std::vector<std::string_view> signal_keys(std::vector<std::string_view> own);
/// 0, 1, 2 of `component = "x"`. Throws Error(invalid_argument).
int read_component(const SettingsTable& table);

}  // namespace palpate
