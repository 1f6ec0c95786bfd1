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

/// How far a model's search went.
enum class ModelProgress {
    finished,    ///< to its end
    compared,    ///< to where evidence told that another model comes first
    far_behind,  ///< to near the optimum, which told the same
    not_fitted  ///< nowhere: with the number of relaxation terms that is tried first its law is far
                ///< behind
};

/// A law with a number of relaxation terms, and what became of it.
struct TriedModel {
    std::string name, experiment_toml;
    std::shared_ptr<const Experiment> experiment;
    /// Of `experiment`; null where it is not fitted. Numbers are those of coarse cells, corrected
    /// to say at one place what the usual ones say, where it is not finished.
    std::shared_ptr<IdentifiedExperiment> found;
    std::vector<std::string> warnings = {};
    ModelProgress progress = ModelProgress::finished;

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

    /// Of the highest evidence, among those whose search went to the end and that nothing speaks
    /// against if there are any; of those that are less than a bare mention behind it the one with
    /// the fewest numbers.
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
