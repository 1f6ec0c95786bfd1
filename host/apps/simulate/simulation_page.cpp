// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/simulation_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/apps/simulate/assets.hpp"
#include "host/apps/simulate/body_figures.hpp"
#include "host/apps/simulate/body_view.hpp"
#include "host/apps/simulate/simulation_findings.hpp"
#include "host/apps/simulate/simulation_plots.hpp"
#include "host/apps/simulate/simulation_tree.hpp"
#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"
#include "host/page/page.hpp"
#include "host/page/solver_figures.hpp"
#include "host/page/surface_view.hpp"
#include "host/system/version.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

std::string card(const std::string& title, const std::string& value, const std::string& unit,
                 const std::string& note) {
    return fmt::format(
        "<div class='finding'><h3>{}</h3><p class='value'>{} <small>{}</small></p><p "
        "class='reason'>{}</p></div>",
        escape_html(title), escape_html(value), escape_html(unit), escape_html(note));
}

std::string signed_percent(double percent) {
    if (std::abs(percent) < 0.005) return "0";
    return fmt::format("{}{}", percent > 0 ? "+" : "−", significant(std::abs(percent)));
}

std::string force_card(const SimulationResult& result) {
    std::size_t strongest = 0;
    for (std::size_t s = 1; s < result.num_holders(); ++s)
        if (largest_force(result, s).size_mn > largest_force(result, strongest).size_mn)
            strongest = s;
    if (result.num_holders() == 0) return "";
    const LargestForce force = largest_force(result, strongest);
    return card(fmt::format("Force of “{}”", result.holder_name(strongest)),
                significant(force.size_mn), "mN",
                "the largest of all, " + time_text(result, result.states[force.state].time_s));
}

std::string findings(const SimulationResult& result) {
    const SimulationState& state = result.states[shown_state(result)];
    const LargestDisplacement moved = largest_displacement(state);
    const Vec3& place = result.mesh().nodes[moved.node];
    const std::string when = time_text(result, state.time_s);
    const auto& stress = state.cells.von_mises_kpa;
    const VolumeChange volume = volume_change(result, state);
    return card("Largest displacement", significant(moved.length_mm), "mm",
                fmt::format("at ({}, {}, {}) mm, {}", significant(place.x()),
                            significant(place.y()), significant(place.z()), when)) +
           force_card(result) +
           card("Largest stress", significant(*std::max_element(stress.begin(), stress.end())),
                "kPa", "von Mises, " + when) +
           card("Volume", signed_percent(volume.percent()), "%",
                fmt::format("of {} mm³, {}", significant(volume.before_mm3), when));
}

std::string notices(const SimulationResult& result) {
    if (result.converged()) return "";
    return fmt::format("<p class='notice bad'><b>Not converged.</b> {}</p>",
                       escape_html(convergence_sentence(result)));
}

/// Kind, nodes and motion of a row of the table.
std::string holder_cells(const SimulationResult& result, std::size_t holder) {
    const std::size_t num_supports = result.prepared.supports.size();
    const auto cells = [](const std::string& kind, const std::string& nodes, double moved_mm) {
        return fmt::format("<td>{}</td><td class='num'>{}</td><td class='num'>{}</td>", kind, nodes,
                           moved_mm > 0 ? significant(moved_mm) : "–");
    };
    if (holder >= num_supports) {
        const ObstacleSettings& obstacle = result.settings.obstacles[holder - num_supports];
        return cells(name_of(obstacle.obstacle.shape), "–", obstacle.motion_mm.norm());
    }
    const SupportSet& set = result.prepared.supports[holder];
    return cells(set.is_fix ? "fixed" : "moved", std::to_string(set.num_nodes),
                 set.displacement_mm.norm());
}

std::string forces_table(const SimulationResult& result) {
    if (result.num_holders() == 0) return "<p>Nothing is held, moved or touched.</p>";
    std::string out =
        "<div class='scroll'><table><thead><tr><th></th><th></th><th class='num'>nodes</th>"
        "<th class='num'>moved, mm</th><th class='num'>x, mN</th><th class='num'>y, mN</th><th "
        "class='num'>z, mN</th><th class='num'>size, mN</th><th>when largest</th></tr></thead>"
        "<tbody>";
    for (std::size_t h = 0; h < result.num_holders(); ++h) {
        const LargestForce force = largest_force(result, h);
        const Vec3& f = result.states[force.state].force_mn[h];
        out += fmt::format(
            "<tr><th>{}</th>{}<td class='num'>{}</td><td class='num'>{}</td><td class='num'>{}</td>"
            "<td class='num'>{}</td><td>{}</td></tr>",
            escape_html(result.holder_name(h)), holder_cells(result, h), significant(f.x()),
            significant(f.y()), significant(f.z()), significant(force.size_mn),
            time_text(result, result.states[force.state].time_s));
    }
    return out + "</tbody></table></div>";
}

/// "mu_kpa" with unit kPa -> "mu".
std::string symbol_of(const MaterialParameter& parameter) {
    std::string name(parameter.name);
    for (const std::string ending : {"_per_kpa", "_kpa"})
        if (name.ends_with(ending)) return name.substr(0, name.size() - ending.size());
    return name;
}

std::string material_text(const SolidMaterial& material) {
    const MaterialDescription& law = material_law(material.law);
    std::string out = escape_html(material.law) + "<br><span class='from'>";
    for (std::size_t k = 0; k < law.parameters.size(); ++k) {
        const MaterialParameter& parameter = law.parameters[k];
        std::string symbol = symbol_of(parameter);
        std::replace(symbol.begin(), symbol.end(), '_', ' ');
        out += fmt::format("{}<span title='{}'>{} {}{}{}</span>", k ? ", " : "",
                           escape_html(parameter.meaning), escape_html(symbol),
                           significant(material.parameters[k]), parameter.unit == "1" ? "" : " ",
                           parameter.unit == "1" ? "" : parameter.unit);
    }
    for (const RelaxationTerm& term : material.relaxation)
        out += fmt::format(", relaxes by {} within {} s", significant(term.amplitude),
                           significant(term.time_s));
    if (!material.relaxation.empty())
        out += fmt::format(" ({} stress{})", name_of(material.relaxation_of),
                           material.is_instantaneous ? "; moduli at t = 0" : "");
    return out + "</span>";
}

struct TissueSums {
    double volume = 0, after = 0, stress = 0, largest = 0;
};

std::string tissues_table(const SimulationResult& result) {
    const SimulationState& state = result.states[shown_state(result)];
    std::vector<TissueSums> sums(result.prepared.labels.size());
    for (Index e = 0; e < result.mesh().num_elements(); ++e) {
        TissueSums& sum = sums[result.mesh().region[e]];
        const double volume = result.element_volume_mm3[e], mises = state.cells.von_mises_kpa[e];
        sum.volume += volume;
        sum.after += volume * state.cells.volume_ratio[e];
        sum.stress += volume * mises;
        sum.largest = std::max(sum.largest, mises);
    }
    std::string out =
        "<div class='scroll'><table><thead><tr><th class='num'>region</th><th>law</th><th "
        "class='num'>volume, mm³</th><th class='num'>change, %</th><th class='num'>mean stress, "
        "kPa</th><th class='num'>largest, kPa</th></tr></thead><tbody>";
    for (std::size_t k = 0; k < sums.size(); ++k)
        out += fmt::format(
            "<tr><td class='num'>{}</td><td>{}</td><td class='num'>{}</td><td class='num'>{}</td>"
            "<td class='num'>{}</td><td class='num'>{}</td></tr>",
            result.prepared.labels[k], material_text(result.settings.materials[k].material),
            significant(sums[k].volume), signed_percent(100 * (sums[k].after / sums[k].volume - 1)),
            significant(sums[k].stress / sums[k].volume), significant(sums[k].largest));
    return out + "</tbody></table></div>";
}

std::string loads_text(const SimulationResult& result) {
    if (result.prepared.is_static)
        return fmt::format("static, in {} {}", result.settings.load_steps,
                           result.settings.load_steps == 1 ? "part" : "parts");
    return fmt::format("{} times up to {} s, {}", result.prepared.time_s.size(),
                       significant(result.prepared.time_s.back()),
                       result.settings.dynamics ? "in motion" : "quasi-static");
}

std::string details(const SimulationResult& result) {
    const SolidMesh& mesh = result.mesh();
    const bool is_slice = mesh.formulation == Formulation::plane_strain ||
                          mesh.formulation == Formulation::plane_stress;
    std::string out = "<dl>";
    const auto add = [&](const std::string& name, const std::string& value) {
        out += fmt::format("<dt>{}</dt><dd>{}</dd>", name, escape_html(value));
    };
    add("Mesh", fmt::format("{} nodes, {} elements of type {}", mesh.num_nodes(),
                            mesh.num_elements(), mesh.table().name));
    add("Formulation",
        std::string(name_of(mesh.formulation)) +
            (is_slice ? fmt::format(", {} mm thick", significant(mesh.thickness_mm)) : ""));
    add("Volume", result.settings.mesh.volume == VolumeTreatment::pointwise
                      ? "as the displacement has it at each point"
                      : "its mean over each element");
    add("Loads", loads_text(result));
    add("Result", convergence_sentence(result));
    if (const auto& motion = result.settings.dynamics) {
        add("Inertia", fmt::format("explicit central differences, {} kg/m³, damping {} 1/s",
                                   significant(motion->density_kg_per_m3),
                                   significant(motion->damping_per_s)));
        return out + "</dl>";
    }
    add("Tolerance",
        fmt::format("relative residual {:g}", result.settings.newton.relative_tolerance));
    if (const auto& solver = result.tangents) add("Tangents", solver_text(*solver));
    for (const auto& [title, value] : titled_rows(simulation_tree(result))) add(title, value);
    return out + "</dl>";
}

std::string headline(const SimulationResult& result) {
    if (!result.settings.title.empty()) return result.settings.title;
    return simulation_sentences(result).front();
}

std::string summary(const SimulationResult& result) {
    const std::string first =
        result.settings.title.empty() ? "" : simulation_sentences(result).front();
    return first + (first.empty() ? "" : " ") +
           (result.converged() ? convergence_sentence(result) : "");
}

std::string wrapped_figures(const std::string& figures) {
    return figures.empty() ? "" : "<div class='figures'>" + figures + "</div>";
}

}  // namespace

std::string simulation_page(const SimulationResult& result) {
    const SimulationState& state = result.states[shown_state(result)];
    const std::string space = surface_viewer_html(body_view(result));
    Page page{
        .kind = "Forward simulation: tissue and loads are given, deformation and forces follow",
        .version = version_text(),
        .headline = escape_html(headline(result)),
        .lead = "<p class='summary'>" + escape_html(summary(result)) + "</p>",
        .notices = notices(result),
        .footer =
            "Lengths in mm, forces in mN, stresses in kPa. For ParaView: "
            "<code>simulation.pvd</code>; for programs: <code>simulation.json</code>.",
        .style = std::string(simulation_css()),
        .scripts = surface_viewer_script() + "startPage(startSurfaceViewers);\n"};
    page.main = fill_template(simulation_html_template(),
                              {{"findings", findings(result)},
                               {"body", space + body_figures(result)},
                               {"force_figures", wrapped_figures(force_figures(result))},
                               {"forces", forces_table(result)},
                               {"tissues", tissues_table(result)},
                               {"when", time_text(result, state.time_s)},
                               {"newton", newton_figure(result) + energy_figure(result)},
                               {"details", details(result)}});
    return page_html(page);
}

}  // namespace palpate
