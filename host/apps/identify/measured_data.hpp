// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/apps/simulate/run_simulation.hpp"
#include "host/estimate/data_problem.hpp"
#include "host/io/number_table.hpp"
#include "host/io/settings_table.hpp"

namespace palpate {

/// What data are compared with: materials always, the solved body if there is one.
struct ExperimentState {
    const std::vector<MaterialSettings>& materials;
    const SimulationResult* simulation = nullptr;
};

/// What one [[data]] measures.
class MeasuredData {
public:
    virtual ~MeasuredData() = default;
    /// Measurements, noise and where they were taken; nothing predicted yet.
    const DataBlock& block() const { return block_; }
    virtual bool needs_simulation() const { return true; }
    /// What the model says [num_row], in the block's unit. Throws Error(solve_failed) if it does
    /// not reach so far, Error(invalid_argument) for what does not fit the model.
    virtual Eigen::VectorXd predicted(const ExperimentState& state) const = 0;

protected:
    DataBlock block_;

private:
    friend std::unique_ptr<MeasuredData> read_data(const SettingsTable&, std::size_t,
                                                   class DataTables&);
};

/// One [[data]] table and its file.
struct DataSource {
    const SettingsTable& table;
    const NumberTable& numbers;
};

/// What a user may know about a kind of data.
struct DataKind {
    std::string_view name;               ///< "force"
    std::string_view sentence;           ///< what it is and which columns its file has
    std::vector<std::string_view> keys;  ///< beside those that all kinds have
    std::unique_ptr<MeasuredData> (*read)(const DataSource& source);
};

/// Tables of files, read once.
class DataTables {
public:
    explicit DataTables(std::filesystem::path folder) : folder_(std::move(folder)) {}
    /// Throws Error(input_unreadable).
    const NumberTable& read(const std::string& file);
    const std::map<std::string, NumberTable>& all() const { return tables_; }

private:
    std::filesystem::path folder_;
    std::map<std::string, NumberTable> tables_;
};

/// The standard deviation of each row: the column `key` of the table, or the number `key` of
/// [[data]] for all. Throws Error(invalid_argument) if there is neither, or one is not above 0.
Eigen::VectorXd read_sd(const DataSource& source, std::string_view key);

Eigen::VectorXd vector_of(const std::vector<double>& values);

}  // namespace palpate
