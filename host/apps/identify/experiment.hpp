// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/simulate/simulation_settings.hpp"
#include "host/estimate/parameter.hpp"

namespace palpate {

/// What an experiment file says with a number in every open place.
struct ExperimentSetup {
    std::vector<MaterialSettings> materials;
    std::optional<SimulationSettings> simulation;  ///< empty: the file has no mesh
    std::vector<std::unique_ptr<MeasuredData>> data;
};

/// An experiment: a model file of `simulate` in which numbers are open, and [[data]] that were
/// measured on it. Without [mesh] there are only materials, for data that need no body.
class Experiment {
public:
    /// Reads the file and the tables that it names. Throws Error(input_unreadable) and
    /// Error(invalid_argument) as `read_simulation` does, and the latter if nothing is unknown or
    /// there are no data.
    static Experiment read(const std::filesystem::path& path);
    /// `folder`: that relative file names start from.
    static Experiment parse(const std::string& toml, const std::string& source_name,
                            const std::filesystem::path& folder);

    /// What people call each number, from its path; empty where nothing better is known.
    void set_words(const std::function<std::string(const std::string& path)>& words_of);

    const std::string& title() const { return title_; }
    bool has_model() const { return has_model_; }  ///< that `simulate` could run
    /// What is looked for, in the order in which the file is read; nuisances too.
    const std::vector<Parameter>& parameters() const { return parameters_; }
    /// Where each stands: "material[1].mu_kpa".
    const std::vector<std::string>& paths() const { return paths_; }
    /// Of the file and its tables: another for other experiments.
    std::uint64_t fingerprint() const;
    /// Whether the deformation depends on a parameter, or only what is read off it.
    bool moves_body(std::size_t parameter) const;

    /// The file with these values [num_parameter].
    ExperimentSetup at(const Eigen::VectorXd& values) const;
    /// The model file that `simulate` runs, with these values in place and without the data. Names
    /// of files are made relative to `folder`.
    std::string model_text(const Eigen::VectorXd& values,
                           const std::filesystem::path& folder) const;

private:
    ExperimentSetup read_with(const OpenNumbers& open_numbers) const;

    std::string text_, source_, title_;
    bool has_model_ = false;
    std::filesystem::path folder_;
    std::vector<Parameter> parameters_;
    std::vector<std::string> paths_;
    std::map<std::string, std::size_t> position_;  ///< of each path
    std::shared_ptr<DataTables> tables_;           ///< read once
};

}  // namespace palpate
