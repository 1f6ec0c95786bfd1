// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/resolution.hpp"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

bool every_load_has_a_column(const SimulationSettings& settings) {
    const auto has = [](const LoadSettings& load) { return load.column.has_value(); };
    return std::all_of(settings.supports.begin(), settings.supports.end(),
                       [&](const SupportSettings& one) { return one.is_fix || has(one); }) &&
           std::all_of(settings.forces.begin(), settings.forces.end(), has) &&
           std::all_of(settings.surface_loads.begin(), settings.surface_loads.end(), has) &&
           std::all_of(
               settings.obstacles.begin(), settings.obstacles.end(),
               [&](const ObstacleSettings& one) { return one.motion_mm.isZero(0) || has(one); });
}

}  // namespace

bool halve_cells(SimulationSettings& settings) {
    MeshSettings& mesh = settings.mesh;
    if (!mesh.file.empty()) return false;
    if (mesh.graded)
        mesh.graded->refine *= 2;
    else
        for (int& count : mesh.grid.divisions) count *= 2;
    return true;
}

bool halve_steps(SimulationSettings& settings) {
    if (!settings.history || settings.dynamics) return false;
    LoadTable& table = *settings.history;
    LoadTable fine{table.columns, {}, {}};
    std::vector<double> before(table.columns.size(), 0.0);
    double before_s = 0;
    const bool halves_first = every_load_has_a_column(settings);
    for (std::size_t row = 0; row < table.time_s.size(); ++row) {
        const std::vector<double>& now = table.factors[row];
        if (row > 0 || halves_first) {
            std::vector<double> middle;
            for (std::size_t k = 0; k < now.size(); ++k)
                middle.push_back(0.5 * (before[k] + now[k]));
            fine.time_s.push_back(0.5 * (before_s + table.time_s[row]));
            fine.factors.push_back(std::move(middle));
        }
        fine.time_s.push_back(table.time_s[row]);
        fine.factors.push_back(now);
        before = now;
        before_s = table.time_s[row];
    }
    table = std::move(fine);
    return true;
}

bool double_cells(SimulationSettings& settings) {
    if (!settings.mesh.graded) return false;
    GradedSettings& graded = *settings.mesh.graded;
    if (graded.refine % 2 == 0) {
        graded.refine /= 2;
        return true;
    }
    if (graded.refine != 1) return false;  // a third of two cells is no line of thirds of each
    const int lines = 2 * graded.coarsen;
    for (const int cells : {graded.columns_inside, graded.columns_outside, graded.rows,
                            graded.edge_of.empty() ? lines : graded.columns_edge})
        if (cells % lines != 0) return false;
    graded.coarsen = lines;
    return true;
}

bool double_steps(SimulationSettings& settings) {
    if (!settings.history || settings.dynamics) return false;
    LoadTable& table = *settings.history;
    if (table.time_s.empty() || table.time_s.size() % 2 != 0) return false;
    LoadTable coarse{table.columns, {}, {}};
    for (std::size_t row = 1; row < table.time_s.size(); row += 2) {
        coarse.time_s.push_back(table.time_s[row]);
        coarse.factors.push_back(std::move(table.factors[row]));
    }
    table = std::move(coarse);
    return true;
}

}  // namespace palpate
