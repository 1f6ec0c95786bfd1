// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/apps/aspirate/fit_input.hpp"
#include "host/apps/identify/experiment.hpp"

namespace palpate {

constexpr const char* points_file = "points.csv";  ///< that an experiment's data are in
constexpr double young_over_mu =
    6;  ///< small strain: the shear modulus is 2 mu, E three times that
constexpr double supposed_friction = 0.3;  ///< where it is unknown

/// What is sucked, how, and what its tissue is taken for at first.
struct SuckedBody {
    RestSurface rest;
    double seen_to_mm = 0;        ///< r up to which `rest` was seen; beyond it is a guess
    double seen_later_to_mm = 0;  ///< r of the farthest point while tissue is sucked
    SuctionSteps steps;
    TissueStart start;
    std::vector<double> moved_mm = {};  ///< [hidden places] of `rest` above its first guess
};

/// Whether a path of an experiment's number is of `rest_error`.
bool is_rest_error(const std::string& path);

/// Moves the hidden part of the surface at rest by what a fit found of `rest_error` [numbers of the
/// experiment's text that are open], and gives the largest distance that a place moved, mm: what is
/// hidden falls outwards, at most by 45 degrees. The prior stays where the guess was.
double move_rest(SuckedBody& sucked, const std::vector<double>& by_mm);

/// The model of a law with `num_terms` relaxation terms, whose numbers are those of the start.
std::string supposed_model_text(const AspirationSettings& settings, const SuckedBody& sucked,
                                const Suction& suction, const std::string& law, int num_terms);

/// The experiment that `palpate identify` reads: numbers of the law and of its relaxation are
/// looked for from the start on, profiles are in `points_file`.
std::string experiment_text(const AspirationSettings& settings, const SuckedBody& sucked,
                            const Suction& suction, const std::string& law, int num_terms);
/// That text, read, its numbers in words of the settings file; `points_file` lies in `folder`.
Experiment tissue_experiment(const std::string& text, const std::filesystem::path& folder);

}  // namespace palpate
