// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/apps/aspirate/tissue_experiment.hpp"
#include "host/apps/aspirate/tissue_halves.hpp"
#include "host/estimate/fit.hpp"
#include "host/estimate/identified.hpp"
#include "solver/base/tasks.hpp"

namespace palpate {

std::string name_of_model(const std::string& law, int num_terms);

/// One law with one number of relaxation terms, and what was seen.
struct TissueModel {
    const AspirationSettings& settings;
    const AspirationFitInput& input;
    const Suction& suction;
    std::string name;  ///< for its progress
    std::string law;
    int num_terms = 0;
    std::filesystem::path inside;  ///< the folder that the points are in
    SolvingOptions solving;
    /// [num_parameter] of an experiment's parameters, as `IdentifyOptions::added_sd`
    std::function<Eigen::VectorXd(const std::vector<Parameter>&)> model_sd;
    /// Whether a fit leaves too much for anybody to believe it: then intervals are quadratic, and
    /// what halves said is dropped.
    std::function<bool(const Fit&)> is_no_model;
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
/// longer changes. `approach` comes first, then `find` and `judge`; where models are compared,
/// `settle` and `weigh` come before these. A part that has thrown is not repeated.
class TissueSearch {
public:
    TissueSearch(TissueModel model, const ProgressSink& progress);

    /// To near the most probable values, mostly by coarse cells.
    ///   simpler   a search for the same law with fewer relaxation terms, one at least, that has
    ///             come near, to begin there; null: none, and several terms begin where a search of
    ///             their own for one comes to
    void approach(const TissueSearch* simpler = nullptr);
    /// On to where evidence can be compared, by coarse cells still; false where these cannot do it.
    bool settle();
    /// To the most probable values.
    ///   halves_beside   whether what `judge` needs of halves is solved on other threads meanwhile
    void find(bool halves_beside);
    /// Intervals by profiles, and halves where they are not yet solved.
    void judge();
    /// Quadratic intervals and evidence of what was found so far.
    void weigh();
    /// What is known so far.
    SearchedTissue found() const;

private:
    void make_experiment();
    bool begin_at(const TissueSearch& simpler);
    bool begin_at_one_term();
    void find_start();
    FitOptions rough_options() const;
    bool fit_corrected(const DataProblem& problem, double gain);
    void fit_roughly(const DataProblem& problem);
    bool rest_is_settled() const;
    void move_surface();
    bool find_rest();
    void find_end();
    SearchPlace place() const;
    std::unique_ptr<const DataProblem> profile_guide() const;
    void report(const char* more) const {
        report_progress(model_.solving.progress, "fit", 0, model_.name + more);
    }

    SharedProgress shared_;
    TissueModel model_;  ///< whose progress is `shared_`
    SuckedBody sucked_;
    FitOptions options_;
    std::vector<Index> rest_errors_;  ///< places of `rest_error` among the numbers
    std::unique_ptr<const ExperimentProblem> coarse_problem_;  ///< `found_.experiment`'s
    std::shared_ptr<const Prediction> coarse_;                 ///< the last one there; may be null
    bool has_rest_ = false;  ///< whether the surface at rest is found
    bool is_near_ = false;   ///< whether a search has led to `options_.start`
    int num_round_ = 0;      ///< of `find_rest`
    bool has_moved_ = true;  ///< the surface at rest, in the last one
    double moved_mm_ = 0;    ///< it, in all of them together
    TissueHalves halves_;
    SearchPlace halved_at_;                             ///< without values: nowhere
    std::unique_ptr<const ExperimentProblem> problem_;  ///< of the end
    SearchedTissue found_;
};

}  // namespace palpate
