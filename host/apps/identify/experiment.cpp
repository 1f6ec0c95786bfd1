// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/experiment.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <utility>

#include "host/apps/identify/open_parameter.hpp"
#include "host/io/closed_document.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr const char* data_key = "data";

}  // namespace

Experiment Experiment::read(const fs::path& path) {
    return parse(text_of_model(path), path.filename().string(), path.parent_path());
}

Experiment Experiment::parse(const std::string& toml, const std::string& source_name,
                             const fs::path& folder) {
    Experiment experiment;
    experiment.text_ = toml;
    experiment.source_ = source_name;
    experiment.folder_ = folder;
    experiment.tables_ = std::make_shared<DataTables>(folder);
    const ExperimentSetup setup = experiment.read_with([&](const OpenNumber& number) {
        const auto [at, is_new] =
            experiment.position_.emplace(number.path, experiment.parameters_.size());
        if (is_new) {
            experiment.parameters_.push_back(parameter_of(number));
            experiment.paths_.push_back(number.path);
        }
        return experiment.parameters_[at->second].start;
    });
    experiment.has_model_ = setup.simulation.has_value();
    if (setup.simulation) experiment.title_ = setup.simulation->title;
    const auto refuse = [&](const char* why) {
        throw Error(ErrorCode::invalid_argument, fmt::format("{}: {}", source_name, why));
    };
    if (setup.data.empty()) refuse("there is no [[data]]; say what was measured");
    bool has_unknown = false;
    for (const Parameter& parameter : experiment.parameters_)
        has_unknown = has_unknown || !parameter.is_nuisance;
    if (!has_unknown) refuse("nothing is \"unknown\"; `palpate simulate` runs a model as it is");
    check_parameters(experiment.parameters_);
    return experiment;
}

ExperimentSetup Experiment::read_with(const OpenNumbers& open_numbers) const {
    const SettingsTable document = SettingsTable::parse(text_, source_, open_numbers);
    std::vector<std::string_view> keys = simulation_keys();
    keys.push_back(data_key);
    document.allow_keys(keys);
    ExperimentSetup setup;
    if (document.has("mesh")) {
        setup.simulation = simulation_of(document, folder_);
        setup.materials = setup.simulation->materials;
    } else {
        setup.materials = read_materials(document);
    }
    std::set<std::string> names;
    for (const SettingsTable& table : document.tables(data_key)) {
        setup.data.push_back(read_data(table, setup.data.size() + 1, *tables_));
        if (setup.data.back()->needs_simulation() && !setup.simulation)
            table.fail("such data need a body; give a [mesh]");
        if (!names.insert(setup.data.back()->block().name).second)
            table.fail("other data have this name; names must differ");
    }
    return setup;
}

void Experiment::set_words(const std::function<std::string(const std::string& path)>& words_of) {
    for (std::size_t k = 0; k < parameters_.size(); ++k) parameters_[k].words = words_of(paths_[k]);
}

std::uint64_t Experiment::fingerprint() const {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
    const auto add = [&](const void* bytes, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k)
            hash = (hash ^ static_cast<const unsigned char*>(bytes)[k]) * 0x100000001b3;
    };
    add(text_.data(), text_.size());
    for (const auto& [file, table] : tables_->all())
        for (const auto& row : table.rows) add(row.data(), row.size() * sizeof row[0]);
    return hash;
}

bool Experiment::moves_body(std::size_t parameter) const {
    return !paths_.at(parameter).starts_with(data_key);
}

ExperimentSetup Experiment::at(const Eigen::VectorXd& values) const {
    return read_with([&](const OpenNumber& number) {
        const double value = values[Eigen::Index(position_.at(number.path))];
        if (!std::isfinite(value))
            throw Error(ErrorCode::solve_failed, number.path + " has no finite value");
        return value;
    });
}

std::string Experiment::model_text(const Eigen::VectorXd& values, const fs::path& folder) const {
    DocumentClosing closing;
    closing.dropped = {data_key};
    for (std::size_t k = 0; k < paths_.size(); ++k)
        closing.numbers[paths_[k]] = values[Eigen::Index(k)];
    closing.file_name = [&](const std::string& file) {
        std::error_code failed;
        const fs::path there = fs::relative(folder_ / file, folder, failed);
        return failed || there.empty() ? file : there.generic_string();
    };
    return closed_document(text_, source_, closing);
}

}  // namespace palpate
