// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/time_steps.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "solver/base/error.hpp"
#include "solver/equilibrium/viscous_history.hpp"

namespace palpate {

void check_times(const std::vector<LoadTime>& times) {
    double before = 0;
    for (const LoadTime& at : times) {
        if (!(at.time_s > before) || !std::isfinite(at.time_s))
            throw Error(ErrorCode::invalid_argument,
                        "times of loads must ascend from above 0 s; there is " +
                            std::to_string(at.time_s) + " after " + std::to_string(before));
        before = at.time_s;
    }
}

namespace {

/// Of a time step and the one before: so far guesses are followed.
constexpr double longest_ratio = 3;

/// The guess of the next time, moved by how far those before were off: that goes on as it went.
Eigen::VectorXd guess_at(const std::vector<LoadTime>& times, const std::vector<Equilibrium>& states,
                         const std::vector<Eigen::VectorXd>& guesses) {
    const std::size_t next = states.size();
    if (next >= guesses.size()) return {};
    const auto is_off = [&](std::size_t n) -> Eigen::VectorXd {
        return states[n].displacement - guesses[n];
    };
    const auto has_size = [&](std::size_t n) {
        return states[n].displacement.size() == guesses[n].size();
    };
    if (next == 0 || !has_size(next - 1)) return guesses[next];
    Eigen::VectorXd off = is_off(next - 1);
    if (next > 1 && has_size(next - 2)) {
        // e_n = u_n - g_n,   u_{n+1} ~ g_{n+1} + e_n + (e_n - e_{n-1}) dt_{n+1} / dt_n
        const double ratio = (times[next].time_s - times[next - 1].time_s) /
                             (times[next - 1].time_s - times[next - 2].time_s);
        off += std::min(ratio, longest_ratio) * (off - is_off(next - 2));
    }
    return guesses[next] + off;
}

}  // namespace

std::vector<Equilibrium> solve_history(const SolidModel& model, const std::vector<LoadTime>& times,
                                       const EquilibriumOptions& options,
                                       const ProgressSink& progress, const TimeObserver& observer,
                                       const std::vector<Eigen::VectorXd>& guesses) {
    check_times(times);
    SolidAssembly solid(model, options.loops);
    ViscousHistory history(model);
    std::vector<Equilibrium> states;
    EquilibriumStart start;
    double now_s = 0;
    for (const LoadTime& at : times) {
        const double dt_s = at.time_s - now_s;
        if (has_relaxation(model)) history.begin_step(dt_s, solid);
        start.guess = guess_at(times, states, guesses);
        states.push_back(solve_equilibrium(solid, at.loads, options, start, progress));
        Equilibrium& found = states.back();
        if (found.converged && has_relaxation(model))
            found.relaxing_stress = solid.relaxing_stress(found.displacement);
        if (observer) observer(solid, found);
        const auto tangent = std::move(found.tangent);  // the assembly ends with this function
        if (!found.converged) break;
        if (has_relaxation(model)) history.end_step(dt_s, std::move(found.relaxing_stress));
        start = {states.back().displacement, at.loads.force, at.loads.obstacle_motion,
                 states.back().contact.friction, at.loads.pressure_kpa};
        start.tangent = tangent;
        now_s = at.time_s;
    }
    return states;
}

}  // namespace palpate
