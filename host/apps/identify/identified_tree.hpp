// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/application.hpp"
#include "host/apps/identify/experiment.hpp"
#include "host/estimate/fit.hpp"
#include "host/estimate/identified.hpp"

namespace palpate {

/// What was found, or of a plan what may be expected.
struct IdentifiedExperiment {
    const Experiment& experiment;
    Fit fit = {};
    Identified identified = {};
    bool is_plan = false;
    int num_start = 1, num_minimum = 1;
    int num_simulation = 0;
    bool is_mesh_checked = false;          ///< whether values are corrected for mesh and time steps
    std::string mesh_check_sentence = {};  ///< what was done about them, or why nothing
    std::string misfit = {};  ///< why this is no model of what was measured; empty: it may be one
    double seconds = 0;

    bool converged() const { return fit.ending == Ending::converged && fit.is_settled; }
    /// In a sentence, why the values are not to be trusted; empty if nothing speaks against it.
    std::string distrust() const;
};

ResultTree identified_tree(const IdentifiedExperiment& found);
/// For a terminal.
std::string identified_text(const IdentifiedExperiment& found);
/// Measured and predicted, a picture for each block.
std::vector<Picture> identified_pictures(const IdentifiedExperiment& found);
/// "data,time_s,x_mm,measured,sd,predicted,unit", a line for each row.
std::string fit_csv(const IdentifiedExperiment& found);

}  // namespace palpate
