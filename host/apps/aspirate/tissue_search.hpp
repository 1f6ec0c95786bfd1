// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/apps/aspirate/tissue_experiment.hpp"
#include "host/apps/identify/experiment.hpp"
#include "host/apps/identify/mesh_check.hpp"
#include "host/apps/simulate/simulation_settings.hpp"
#include "host/estimate/fit.hpp"
#include "host/estimate/identified.hpp"

namespace palpate {

/// One law with one number of relaxation terms, and what was seen.
struct TissueSearch {
    const AspirationSettings& settings;
    const AspirationFitInput& input;
    const Suction& suction;
    std::string name;  ///< of the model, for its progress
    std::string law;
    int num_terms = 0;
    std::filesystem::path inside;  ///< the folder that the points are in
    std::function<void(SimulationSettings&)> configure;
    int jobs = 1;
    ProgressSink progress;
};

/// The experiment that came out, and its most probable tissue.
struct SearchedTissue {
    std::string experiment_toml;
    std::shared_ptr<const Experiment> experiment;
    Fit fit;
    Identified identified;
    /// What halving cells changes at these values or near them, and halving time steps; empty: not
    /// all of it could be solved, or the fit is not believed.
    std::vector<HalvedModel> halved;
    bool is_believed = true;
    int num_simulation = 0;
};

/// Begins where cells and time steps of twice the size have an optimum. What a fit finds of the
/// hidden part of the surface at rest is a part of the body that the next fit has, until it no
/// longer changes.
///   model_sd      [num_parameter] of an experiment's parameters, as `IdentifyOptions::added_sd`
///   is_no_model   whether a fit leaves too much for anybody to believe it: then intervals are
///                 quadratic, and what halves said is dropped
SearchedTissue search_tissue(
    const TissueSearch& search,
    const std::function<Eigen::VectorXd(const std::vector<Parameter>&)>& model_sd,
    const std::function<bool(const Fit&)>& is_no_model);

}  // namespace palpate
