// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/simulation_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/apps/simulate/simulation_findings.hpp"
#include "host/page/legend.hpp"
#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double plot_width = 440, plot_height = 270;
constexpr std::size_t fewest_states = 3;  ///< a curve through less says nothing
constexpr std::size_t most_marks = 60;    ///< more would hide the curve

struct Curve {
    std::string name;
    std::vector<double> x, y;
};

std::string figure(const std::string& legend, const std::string& svg, const std::string& caption) {
    return fmt::format("<figure>{}{}<figcaption>{}</figcaption></figure>", legend, svg,
                       escape_html(caption));
}

/// Round the values, with 0 inside and a little room.
PlotAxis axis_of(const std::vector<Curve>& curves, std::vector<double> Curve::*values,
                 const std::string& label) {
    double low = 0, high = 0;
    for (const Curve& curve : curves)
        for (const double value : curve.*values) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    const double room = high > low ? 0.05 * (high - low) : 1;
    return {low < 0 ? low - room : 0, high > 0 ? high + room : (low < 0 ? 0 : room), false, label};
}

std::string curves_figure(const std::string& id, const std::vector<Curve>& curves,
                          const std::string& x_label, const std::string& y_label,
                          const std::string& title, const std::string& caption) {
    if (curves.empty()) return "";
    PlotAxis x = axis_of(curves, &Curve::x, x_label);
    const PlotAxis y = axis_of(curves, &Curve::y, y_label);
    Plot plot(id, plot_width, plot_height, x, y);
    if (y.low < 0 && y.high > 0) plot.guide({x.low, x.high}, {0, 0}, "");
    std::vector<LegendEntry> legend;
    for (std::size_t k = 0; k < curves.size(); ++k) {
        plot.curve(curves[k].x, curves[k].y, list_colour(k), curves[k].x.size() <= most_marks);
        legend.push_back({curves[k].name, list_colour(k)});
    }
    return figure(legend_html(legend), plot.svg(title), caption);
}

/// The component that is largest over the run: 0, 1 or 2; -1 if none is above rounding.
int main_component(const SimulationResult& result, std::size_t holder, double negligible) {
    Vec3 largest = Vec3::Zero();
    for (const SimulationState& state : result.states)
        largest = largest.cwiseMax(state.force_mn[holder].cwiseAbs());
    int component = 0;
    return largest.maxCoeff(&component) > negligible ? component : -1;
}

std::vector<double> times_of(const SimulationResult& result) {
    std::vector<double> times;
    const double factor = result.prepared.is_static ? 100 : 1;
    for (const SimulationState& state : result.states) times.push_back(factor * state.time_s);
    return times;
}

std::string time_label(const SimulationResult& result) {
    return result.prepared.is_static ? "part of the load, %" : "time, s";
}

std::string forces_over_time(const SimulationResult& result) {
    double largest = 0;
    for (std::size_t h = 0; h < result.num_holders(); ++h)
        largest = std::max(largest, largest_force(result, h).size_mn);
    std::vector<Curve> curves;
    for (std::size_t h = 0; h < result.num_holders(); ++h) {
        const int component = main_component(result, h, 1e-6 * largest);
        if (component < 0) continue;
        Curve curve{
            fmt::format("{}, {}", result.holder_name(h), static_cast<char>('x' + component)),
            times_of(result),
            {}};
        for (const SimulationState& state : result.states)
            curve.y.push_back(state.force_mn[h][component]);
        curves.push_back(std::move(curve));
    }
    return curves_figure(
        "force-time", curves, time_label(result), "force on the body, mN",
        "Forces on the body over time",
        "Force that each support and obstacle exerts on the body: its largest component.");
}

/// Where a support or obstacle that moves by `full` is in each state, mm along it; empty if it
/// holds nothing there.
std::vector<double> distances_moved(const SimulationResult& result, std::size_t holder,
                                    const Vec3& full) {
    std::vector<double> distances;
    const std::size_t num_supports = result.prepared.supports.size();
    if (holder >= num_supports) {
        for (const SimulationState& state : result.states)
            distances.push_back(
                state.obstacle_motion_mm[holder - num_supports].dot(full.normalized()));
        return distances;
    }
    const std::vector<Index>& dofs = result.prepared.supports[holder].dofs;
    const auto dof =
        std::find_if(dofs.begin(), dofs.end(), [&](Index d) { return full[d % 3] != 0; });
    if (dof == dofs.end()) return distances;
    for (const SimulationState& state : result.states)
        distances.push_back(full.norm() * state.displacement[*dof] / full[*dof % 3]);
    return distances;
}

Vec3 full_motion(const SimulationResult& result, std::size_t holder) {
    const std::size_t num_supports = result.prepared.supports.size();
    return holder < num_supports ? result.prepared.supports[holder].displacement_mm
                                 : result.settings.obstacles[holder - num_supports].motion_mm;
}

/// Force along the motion over the distance moved, for all that moves.
std::string forces_over_displacement(const SimulationResult& result) {
    std::vector<Curve> curves;
    for (std::size_t h = 0; h < result.num_holders(); ++h) {
        const Vec3 full = full_motion(result, h);
        if (full.norm() == 0) continue;
        Curve curve{result.holder_name(h), distances_moved(result, h, full), {}};
        if (std::set<double>(curve.x.begin(), curve.x.end()).size() < fewest_states) continue;
        for (const SimulationState& state : result.states)
            curve.y.push_back(state.force_mn[h].dot(full.normalized()));
        curves.push_back(std::move(curve));
    }
    return curves_figure("force-displacement", curves, "moved, mm", "force along the motion, mN",
                         "Force over displacement",
                         "Force along the motion over the distance moved.");
}

std::string displacement_over_time(const SimulationResult& result) {
    Curve curve{"largest displacement", times_of(result), {}};
    for (const SimulationState& state : result.states)
        curve.y.push_back(largest_displacement(state).length_mm);
    return curves_figure("displacement-time", {curve}, time_label(result), "displacement, mm",
                         "Largest displacement over time",
                         "Displacement of the point that moves farthest.");
}

}  // namespace

std::string force_figures(const SimulationResult& result) {
    if (result.states.size() < fewest_states) return "";
    const std::string moved = forces_over_displacement(result);
    return forces_over_time(result) + (moved.empty() ? displacement_over_time(result) : moved);
}

std::string energy_figure(const SimulationResult& result) {
    if (!result.settings.dynamics || result.states.size() < fewest_states) return "";
    Curve stored{"stored in the tissue", times_of(result), {}},
        kinetic{"of the motion", stored.x, {}};
    for (const SimulationState& state : result.states) {
        stored.y.push_back(state.energy_mn_mm);
        kinetic.y.push_back(state.kinetic_energy_mn_mm);
    }
    return curves_figure("energy", {stored, kinetic}, time_label(result), "energy, mN mm",
                         "Energies over time", "Energy stored and energy of the motion.");
}

std::string newton_figure(const SimulationResult& result) {
    const double tolerance = result.settings.newton.relative_tolerance;
    double low = tolerance, high = tolerance;
    Curve curve;
    for (const SimulationStep& step : result.steps) {
        for (const NewtonRecord& record : step.records) {
            curve.x.push_back(static_cast<double>(curve.x.size()) + 1);
            curve.y.push_back(std::max(record.relative_residual, 1e-3 * tolerance));
            low = std::min(low, curve.y.back());
            high = std::max(high, curve.y.back());
        }
    }
    if (curve.x.empty()) return "";
    Plot plot("newton", plot_width, plot_height,
              {0.5, curve.x.back() + 0.5, false, "Newton step, all load steps in a row"},
              {low / 3, high * 3, true, "relative residual"});
    plot.horizontal_rule(tolerance, "tolerance");
    std::size_t at = 0;
    for (const SimulationStep& step : result.steps) {
        // One line for each load that was tried.
        for (std::size_t k = 0; k < step.records.size();) {
            std::size_t end = k + 1;
            while (end < step.records.size() && step.records[end].load == step.records[k].load &&
                   step.records[end - 1].step_length != 0)
                ++end;
            const auto part = [&](const std::vector<double>& values) {
                return std::vector<double>(values.begin() + at + k, values.begin() + at + end);
            };
            plot.curve(part(curve.x), part(curve.y), "var(--accent)",
                       curve.x.size() <= 2 * most_marks);
            k = end;
        }
        at += step.records.size();
    }
    return figure("", plot.svg("Residual over Newton steps"),
                  "What the forces lack to equilibrium, relative to their size. Each line is one "
                  "load; it ends below the tolerance.");
}

}  // namespace palpate
