// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/apps/aspirate/film_outlines.hpp"
#include "host/apps/aspirate/fit_input.hpp"
#include "host/apps/identify/identified_tree.hpp"

namespace palpate {

/// A law with a number of relaxation terms, and what became of it.
struct TriedModel {
    std::string name, experiment_toml;
    std::shared_ptr<const Experiment> experiment;
    std::shared_ptr<IdentifiedExperiment> found;  ///< of `experiment`
    std::vector<std::string> warnings = {};

    Index num_parameter() const { return Index(experiment->parameters().size()); }
};

/// All that a fit of an aspiration is told of.
struct AspirationFit {
    AspirationSettings settings;
    AspirationFitInput input;
    Suction suction;
    std::vector<TriedModel> models;

    /// Of what was read and of the best model.
    std::vector<std::string> warnings() const;

    /// Of the highest evidence, among those that nothing speaks against if there are any; of those
    /// that are less than a bare mention behind it the one with the fewest numbers.
    const TriedModel& best() const;
};

/// `result.json`: that of `palpate identify` for the best model, what was looked at, and a list of
/// all models with their evidence.
ResultTree fit_tree(const AspirationFit& fit);
/// For a terminal.
std::string fit_text(const AspirationFit& fit);
/// `report.html`, with the frames and their outlines if there is a film.
std::string fit_page(const AspirationFit& fit, const ResultTree& tree, const FilmOutlines* film);

}  // namespace palpate
