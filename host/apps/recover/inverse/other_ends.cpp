// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>

#include "host/apps/recover/inverse/map_estimate.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::array other_walls = {FirstWalls::sliding, FirstWalls::broad};
constexpr double tolerance_sd = 0.1, tolerance_per_row = 1e-3;
constexpr auto between_looks = std::chrono::milliseconds(50);

/// Searches that still run when something throws are not waited for to their ends.
struct StopAtEnd {
    std::atomic<bool>& is_stopped;
    ~StopAtEnd() { is_stopped = true; }
};

/// Without what is only of use while the observations live.
std::shared_ptr<const MapEstimate> told_of(MapEstimate end) {
    end.posterior.reset();
    end.walls.reset();
    end.response.reset();
    end.noise.reset();
    end.counted.reset();
    return std::make_shared<const MapEstimate>(std::move(end));
}

}  // namespace

std::vector<std::shared_ptr<const MapEstimate>> other_ends(
    const MapEstimate& found, const ResponseModel& model, const WallPrior& walls,
    const SurfaceObservations& observations, const std::vector<Unknown>& unknowns,
    const MapOptions& options, const ProgressSink& progress) {
    report_progress(progress, "searching", -1, "from other places");
    std::atomic<bool> is_stopped{false};
    const ProgressSink stop = [&](const Progress&) {
        if (is_stopped) throw Error(ErrorCode::cancelled, "another search was stopped");
    };
    std::array<MapOptions, other_walls.size()> begins;
    std::vector<std::future<MapEstimate>> searches;
    const StopAtEnd stop_at_end{is_stopped};  // before `searches`, which wait, come to their end
    for (std::size_t k = 0; k < other_walls.size(); ++k) {
        begins[k] = options;
        begins[k].first_walls = other_walls[k];
        // Where they end matters, to a part of what an interval is wide.
        begins[k].modulus_tolerance_sd = std::max(options.modulus_tolerance_sd, tolerance_sd);
        begins[k].objective_tolerance_per_row =
            std::max(options.objective_tolerance_per_row, tolerance_per_row);
        begins[k].known_end = {found.driven, found.theta,
                               found.covariance.diagonal().cwiseAbs().cwiseSqrt()};
        searches.push_back(std::async(std::launch::async, [&, k] {
            return map_estimate(model, walls, observations, unknowns, begins[k], stop);
        }));
    }
    std::exception_ptr stopped;
    for (const auto& search : searches)
        while (search.wait_for(between_looks) != std::future_status::ready) try {
                if (!stopped) check_cancelled(progress);
            } catch (...) {
                stopped = std::current_exception();
                is_stopped = true;
            }
    if (stopped) std::rethrow_exception(stopped);
    std::vector<std::shared_ptr<const MapEstimate>> ends;
    for (auto& search : searches) try {
            MapEstimate end = search.get();
            if (!end.interval_kpa.empty() && end.termination.converged)
                ends.push_back(told_of(std::move(end)));
        } catch (const Error& error) {
            // A way that leads nowhere says nothing of the one that was found.
            if (error.code() != ErrorCode::solve_failed) throw;
        }
    return ends;
}

}  // namespace palpate
