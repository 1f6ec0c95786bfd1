// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "host/apps/identify/experiment.hpp"
#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/identify/mesh_check.hpp"
#include "host/apps/simulate/simulation_settings.hpp"
#include "solver/base/error.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Whether coarse or fine cells may have an error where those of the experiment have none.
bool is_of_model(const Error& error);

/// How an experiment is solved.
struct SolvingOptions {
    std::function<void(SimulationSettings&)> configure;
    double peak_stiffness_kpa = 0;  ///< Young's modulus at the peak, a guess
    int jobs = 1;
    ProgressSink progress = {};
};

/// Cells, or time steps, of twice or half the size (`resolution.hpp`); false: they cannot be.
using Resizing = bool (*)(SimulationSettings&);

/// The experiment on other cells and time steps, with a bulk modulus of no more than this over
/// Young's modulus.
ExperimentProblem resized_problem(
    const Experiment& experiment, const std::vector<Resizing>& resizings,
    const SolvingOptions& solving,
    double kappa_over_young = std::numeric_limits<double>::infinity());

/// What a search has come to.
struct SearchPlace {
    std::shared_ptr<const Experiment> experiment;
    Eigen::VectorXd values;
    std::shared_ptr<const Prediction> guess;
    double moved_mm = 0;  ///< of the surface at rest, until there
};

/// Whether what halves change is nearly the same at both.
bool are_near(const SearchPlace& first, const SearchPlace& second);

/// What cells h / 2 change with time steps 2 dt, and steps dt / 2 with cells 2 h: what the one
/// changes hardly depends on the other, and this costs about half of (h / 2, dt) and (h, dt / 2).
class TissueHalves {
public:
    static constexpr std::size_t num_pair = 2;

    /// `solving` must outlive it.
    explicit TissueHalves(const SolvingOptions& solving) : solving_(solving) {}

    /// Whether cells and steps can be resized there.
    static bool can_halve(const SearchPlace& place);
    /// Solves a pair, the dearest first; what cannot be solved stays null. Others may be solved at
    /// the same time.
    void halve(std::size_t pair, const SearchPlace& place);
    bool are_halved() const;
    void clear() { halved_ = {}; }
    /// Empty if not all could be solved.
    std::vector<HalvedModel> pairs() const;
    int num_simulation() const { return num_simulation_; }

private:
    std::shared_ptr<const Prediction> resized_prediction(const SearchPlace& place,
                                                         const std::vector<Resizing>& resizings,
                                                         const Prediction* warm);

    const SolvingOptions& solving_;
    std::array<HalvedModel, num_pair> halved_;
    std::atomic<int> num_simulation_ = 0;
};

}  // namespace palpate
