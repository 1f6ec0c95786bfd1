// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/experiment_problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/apps/identify/guess_transfer.hpp"
#include "host/apps/identify/path_direction.hpp"
#include "solver/base/error.hpp"
#include "solver/base/tasks.hpp"

namespace palpate {
namespace {

constexpr double difference_step = 1e-4;  ///< h, of a logarithm or in prior sd of other scales

/// h on the transformed scale of a parameter.
double step_of(const Parameter& parameter, double value) {
    if (parameter.transform != Transform::identity) return difference_step;
    if (parameter.has_prior()) return std::min(1.0, 100 * difference_step) * parameter.sd;
    return difference_step * std::max(std::abs(value), 1e-3);
}

/// Whether other values may have no such error: no equilibrium, or a number of the file that is not
/// allowed, a place outside a body that is smaller.
bool is_of_values(const Error& error) {
    return error.code() == ErrorCode::solve_failed || error.code() == ErrorCode::invalid_argument ||
           error.code() == ErrorCode::input_unusable || error.code() == ErrorCode::mesh_failed;
}

/// A trial far from any equilibrium is given up early: the search then takes a shorter step, which
/// costs less than the last halving of a load.
void limit_trial(EquilibriumOptions& newton) {
    constexpr double shortest = 1.0 / 16;
    constexpr int most_steps = 20;
    newton.smallest_step = std::max(newton.smallest_step, std::min(shortest, newton.first_step));
    newton.max_newton_steps = std::min(newton.max_newton_steps, most_steps);
}

/// The states moved along a column, and the body at rest.
SimulationResult moved_along(const SimulationResult& simulation, int column, double distance) {
    SimulationResult moved = simulation;
    for (std::size_t s = 0; s < simulation.columns.size(); ++s) {
        const StateColumns& columns = simulation.columns[s];
        moved.states[s].displacement += distance * columns.displacement.col(column);
        for (std::size_t k = 0; k < columns.force_mn.size(); ++k)
            moved.states[s].force_mn[k] += distance * columns.force_mn[k].col(column);
    }
    const Eigen::VectorXd& places = simulation.place_columns[std::size_t(column)];
    std::vector<Vec3>& nodes = moved.prepared.model.mesh.nodes;
    for (std::size_t n = 0; places.size() > 0 && n < nodes.size(); ++n)
        nodes[n] += distance * places.segment<3>(3 * Eigen::Index(n));
    return moved;
}

/// u_n + (du_n/dp) dp at all times of `settings`, of the numbers that have columns; empty if the
/// earlier simulation did not come to its end.
std::vector<Eigen::VectorXd> guesses_from(const ExperimentPrediction& earlier,
                                          const Eigen::VectorXd& values,
                                          const std::optional<SimulationSettings>& settings) {
    std::vector<Eigen::VectorXd> moved;
    if (!settings || !earlier.simulation || !earlier.simulation->converged()) return moved;
    const SimulationResult& from = *earlier.simulation;
    if (from.settings.dynamics) return moved;
    for (std::size_t s = 0; s < from.states.size(); ++s) {
        Eigen::VectorXd u = from.states[s].displacement;
        for (std::size_t k = 0; k < earlier.column_of.size(); ++k)
            if (earlier.column_of[k] >= 0 && s < from.columns.size())
                u += from.columns[s].displacement.col(earlier.column_of[k]) *
                     (values[Eigen::Index(k)] - earlier.values[Eigen::Index(k)]);
        moved.push_back(std::move(u));
    }
    return transferred_guesses(*settings, from, moved);
}

std::size_t next_number() {
    static std::atomic<std::size_t> last = 0;
    return ++last;
}

}  // namespace

std::shared_ptr<const Prediction> moved_guess(const Prediction& exact, const Prediction& other,
                                              const Prediction& moved,
                                              const Eigen::VectorXd& values) {
    const auto* from = dynamic_cast<const ExperimentPrediction*>(solved_of(&exact));
    const auto* before = dynamic_cast<const ExperimentPrediction*>(solved_of(&other));
    const auto* after = dynamic_cast<const ExperimentPrediction*>(solved_of(&moved));
    if (!from || !before || !after || !from->simulation || !from->simulation->converged())
        return nullptr;
    const SimulationSettings& settings = from->simulation->settings;
    const auto less = guesses_from(*before, from->values, settings);
    const auto more = guesses_from(*after, values, settings);
    const std::size_t num_times = from->simulation->states.size() - 1;  // the first is at rest
    if (less.size() != num_times || more.size() != num_times) return nullptr;
    auto simulation = std::make_shared<SimulationResult>(*from->simulation);
    for (std::size_t i = 0; i < num_times; ++i)
        // u_exact + u_other(values) - u_other
        simulation->states[i + 1].displacement += more[i] - less[i];
    simulation->columns.clear();
    auto guess = std::make_shared<ExperimentPrediction>();
    guess->values = from->values;  // where there is a prediction for sure
    guess->simulation = std::move(simulation);
    return guess;
}

std::shared_ptr<const Prediction> guess_for(const Prediction& other,
                                            const Eigen::VectorXd& values) {
    const auto* from = dynamic_cast<const ExperimentPrediction*>(solved_of(&other));
    if (!from || !from->simulation || !from->simulation->converged()) return nullptr;
    auto simulation = std::make_shared<SimulationResult>(*from->simulation);
    simulation->columns.clear();
    auto guess = std::make_shared<ExperimentPrediction>();
    guess->values = values;
    guess->simulation = std::move(simulation);
    return guess;
}

ExperimentProblem::ExperimentProblem(const Experiment& experiment,
                                     std::function<void(SimulationSettings&)> configure, int jobs,
                                     ProgressSink progress)
    : experiment_(experiment),
      configure_(std::move(configure)),
      jobs_(jobs),
      progress_(std::move(progress)),
      number_(next_number()) {}

std::optional<SimulationSettings> ExperimentProblem::configured(
    const ExperimentSetup& setup) const {
    if (!setup.simulation) return std::nullopt;
    SimulationSettings settings = *setup.simulation;
    configure_(settings);
    return settings;
}

std::shared_ptr<const SimulationResult> ExperimentProblem::simulate(
    std::optional<SimulationSettings> settings, SimulationWish wish,
    const ProgressSink& progress) const {
    if (!settings) return nullptr;
    if (!wish.guesses.empty()) limit_trial(settings->newton);
    ++num_simulation_;
    wish.fills_cells = false;
    wish.jobs = jobs_here(jobs_);
    const auto ask_only = [&](const Progress&) { check_cancelled(progress); };
    return std::make_shared<const SimulationResult>(run_simulation(*settings, ask_only, wish));
}

std::vector<Eigen::VectorXd> ExperimentProblem::read_off(const ExperimentSetup& setup,
                                                         const SimulationResult* simulation) const {
    std::vector<Eigen::VectorXd> blocks;
    for (const auto& data : setup.data)
        blocks.push_back(data->predicted({setup.materials, simulation}));
    return blocks;
}

void ExperimentProblem::simulate_with_columns(const std::optional<SimulationSettings>& settings,
                                              ExperimentPrediction& made,
                                              SimulationWish wish) const {
    made.column_of.assign(parameters().size(), -1);
    if (!settings || settings->dynamics) {
        made.simulation = simulate(settings, {}, progress_);
        return;
    }
    wish.directions = [&](const PreparedSimulation& prepared, const std::vector<LoadTime>&) {
        std::vector<HistoryDirection> list;
        for (std::size_t k = 0; k < parameters().size(); ++k) {
            const auto moved = [&](double by) {
                Eigen::VectorXd values = made.values;
                values[Eigen::Index(k)] += by;
                return *configured(experiment_.at(values));
            };
            auto direction = direction_of(experiment_.paths()[k], prepared, *settings, moved);
            if (!direction) continue;
            made.column_of[k] = static_cast<int>(list.size());
            list.push_back(std::move(*direction));
        }
        return list;
    };
    made.simulation = simulate(settings, std::move(wish), progress_);
}

PredictionAttempt ExperimentProblem::predict(const Eigen::VectorXd& values,
                                             PredictedColumns columns,
                                             const Prediction* warm) const {
    check_cancelled(progress_);
    const bool wants_columns = columns == PredictedColumns::wanted;
    const auto* earlier = dynamic_cast<const ExperimentPrediction*>(warm);
    if (earlier && earlier->problem == number_ && earlier->values == values &&
        (!wants_columns || earlier->blocks.front().columns.size() > 0))
        return {std::make_shared<ExperimentPrediction>(*earlier), ""};
    try {
        return {predicted_anew(values, wants_columns, earlier), ""};
    } catch (const Error& error) {
        // At the start the file itself is wrong.
        if (!is_of_values(error) || values == starts_of(parameters())) throw;
        return {nullptr, error.what()};
    }
}

std::shared_ptr<const Prediction> ExperimentProblem::predicted_anew(
    const Eigen::VectorXd& values, bool wants_columns, const ExperimentPrediction* warm) const {
    auto made = std::make_shared<ExperimentPrediction>();
    made->values = values;
    made->problem = number_;
    const ExperimentSetup setup = experiment_.at(values);
    const std::optional<SimulationSettings> settings = configured(setup);
    SimulationWish wish;
    if (warm) wish.guesses = guesses_from(*warm, values, settings);
    if (wants_columns)
        simulate_with_columns(settings, *made, std::move(wish));
    else
        made->simulation = simulate(settings, std::move(wish), progress_);
    const auto predicted = read_off(setup, made->simulation.get());
    for (std::size_t k = 0; k < setup.data.size(); ++k) {
        made->blocks.push_back(setup.data[k]->block());
        made->blocks.back().predicted = predicted[k];
    }
    if (wants_columns) add_columns(*made);
    return made;
}

std::vector<Eigen::VectorXd> ExperimentProblem::predicted_at(double value, std::size_t parameter,
                                                             const ExperimentPrediction& centre,
                                                             const ProgressSink& progress) const {
    const Eigen::Index k = Eigen::Index(parameter);
    Eigen::VectorXd values = centre.values;
    values[k] = value;
    const ExperimentSetup setup = experiment_.at(values);
    if (!experiment_.moves_body(parameter)) return read_off(setup, centre.simulation.get());
    const int column = centre.column_of[parameter];
    if (column < 0) {
        const std::optional<SimulationSettings> settings = configured(setup);
        SimulationWish wish;
        wish.guesses = guesses_from(centre, values, settings);
        return read_off(setup, simulate(settings, std::move(wish), progress).get());
    }
    const SimulationResult moved =
        moved_along(*centre.simulation, column, value - centre.values[k]);
    return read_off(setup, &moved);
}

/// One-sided where a side has no solution.
void ExperimentProblem::set_column(ExperimentPrediction& prediction, std::size_t parameter,
                                   const ProgressSink& progress) const {
    const Parameter& one = parameters()[parameter];
    const Eigen::Index k = Eigen::Index(parameter);
    const double t = to_transformed(one, prediction.values[k]);
    const double h = step_of(one, prediction.values[k]);
    const auto side = [&](double sign) -> std::pair<double, std::vector<Eigen::VectorXd>> {
        const double value = to_value(one, t + sign * h);
        if (value >= one.lowest && value <= one.highest) try {
                return {value, predicted_at(value, parameter, prediction, progress)};
            } catch (const Error& error) {
                if (!is_of_values(error)) throw;
            }
        std::vector<Eigen::VectorXd> centre;
        for (const DataBlock& block : prediction.blocks) centre.push_back(block.predicted);
        return {prediction.values[k], std::move(centre)};
    };
    const auto [low, below] = side(-1);
    const auto [high, above] = side(1);
    if (low == high)
        throw Error(ErrorCode::solve_failed, "no equilibrium on either side of " + label_of(one));
    for (std::size_t b = 0; b < prediction.blocks.size(); ++b)
        prediction.blocks[b].columns.col(k) = (above[b] - below[b]) / (high - low);
}

void ExperimentProblem::add_columns(ExperimentPrediction& prediction) const {
    const std::size_t count = parameters().size();
    for (DataBlock& block : prediction.blocks)
        block.columns.setZero(block.num_row(), Eigen::Index(count));
    SharedProgress progress(progress_);
    run_tasks(count, jobs_, progress,
              [&](std::size_t k) { set_column(prediction, k, progress.sink()); });
}

}  // namespace palpate
