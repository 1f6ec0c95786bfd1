// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/apps/identify/experiment.hpp"
#include "host/apps/simulate/run_simulation.hpp"
#include "host/estimate/data_problem.hpp"

namespace palpate {

/// What a model says, with the body that says it.
struct ExperimentPrediction : Prediction {
    std::shared_ptr<const SimulationResult> simulation;  ///< null without a mesh
    std::size_t problem = 0;                             ///< whose it is
    /// [num_parameter] column of `simulation->columns` of each; -1: none.
    std::vector<int> column_of = {};
};

/// An experiment as an inverse problem: a prediction is a simulation. What is read off it has
/// columns
///   dy/dp = dy/du du/dp,   du/dp from HistoryColumns at the cost of a solve each,
/// for parameters of laws, relaxation, friction, sizes of obstacles and of loads (direction_of);
/// what only changes how a body is read costs no simulation; for all others two whole simulations,
/// side by side, are compared on the scale on which the parameter is searched,
///   d y/d t ~ (y(t + h) - y(t - h)) / 2h.
/// A simulation with other values begins at all times from u_n + (du_n/dp) dp of an earlier one, of
/// this problem or of one with other cells and times (`transferred_guesses`).
class ExperimentProblem : public DataProblem {
public:
    /// `experiment` must outlive this. `configure` sets how equations are solved. `jobs`
    /// simulations run at the same time.
    ExperimentProblem(const Experiment& experiment,
                      std::function<void(SimulationSettings&)> configure, int jobs,
                      ProgressSink progress);

    const std::vector<Parameter>& parameters() const override { return experiment_.parameters(); }
    PredictionAttempt predict(const Eigen::VectorXd& values, PredictedColumns columns,
                              const Prediction* warm) const override;
    /// Simulations so far.
    int num_simulation() const { return num_simulation_; }

private:
    std::optional<SimulationSettings> configured(const ExperimentSetup& setup) const;
    std::shared_ptr<const SimulationResult> simulate(std::optional<SimulationSettings> settings,
                                                     SimulationWish wish,
                                                     const ProgressSink& progress) const;
    void simulate_with_columns(const std::optional<SimulationSettings>& settings,
                               ExperimentPrediction& made, SimulationWish wish) const;
    std::shared_ptr<const Prediction> predicted_anew(const Eigen::VectorXd& values,
                                                     bool wants_columns,
                                                     const ExperimentPrediction* warm) const;
    std::vector<Eigen::VectorXd> read_off(const ExperimentSetup& setup,
                                          const SimulationResult* simulation) const;
    /// What is predicted where parameter `parameter` has another value.
    std::vector<Eigen::VectorXd> predicted_at(double value, std::size_t parameter,
                                              const ExperimentPrediction& centre,
                                              const ProgressSink& progress) const;
    void add_columns(ExperimentPrediction& prediction) const;
    void set_column(ExperimentPrediction& prediction, std::size_t parameter,
                    const ProgressSink& progress) const;

    const Experiment& experiment_;
    std::function<void(SimulationSettings&)> configure_;
    int jobs_;
    ProgressSink progress_;
    std::size_t number_;  ///< of all problems
    mutable std::atomic<int> num_simulation_ = 0;
};

/// Something for a prediction at `values` to begin with, and good for nothing else: it has the
/// values of `exact`, and displacements of that moved by what another model of the experiment, on
/// other cells or at other times, says that values change,
///   u ~ u_exact + u_other(values) - u_other(values of `exact`).
///   other   of that model at the values of `exact`
///   moved   of that model at `values`, or near them with columns
/// Null where one of them has no body or cells differ in another way (`transferred_guesses`).
std::shared_ptr<const Prediction> moved_guess(const Prediction& exact, const Prediction& other,
                                              const Prediction& moved,
                                              const Eigen::VectorXd& values);

/// The displacements of another experiment's prediction, for one at `values` to begin with. Null
/// where the other has no body.
std::shared_ptr<const Prediction> guess_for(const Prediction& other, const Eigen::VectorXd& values);

}  // namespace palpate
