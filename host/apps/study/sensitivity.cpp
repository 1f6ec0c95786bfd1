// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/apps/phantom/spheres.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/studies.hpp"
#include "host/apps/study/tables.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr Index num_layers = 30;
constexpr double moduli_kpa[] = {5, 10, 20, 50, 100, 150, 200, 250, 300, 350};
constexpr double pressures_kpa[] = {0.5, 1, 2, 3, 4};
const std::vector<std::string> line_colours{"#2f86c9", "#009e73", "#d55e00", "#8a63c9", "#c79a00"};

SpheresOptions spheres_of(double modulus_kpa, double pressure_kpa) {
    SpheresOptions spheres;
    spheres.inner.stiffness_kpa = modulus_kpa;
    spheres.pressure_kpa = pressure_kpa;
    return spheres;
}

Row solve(const SpheresOptions& spheres, const LinearSolverOptions& solver) {
    const double exact = pressed_inner_radius_mm(spheres);
    const double solved = solved_inner_radius_mm(spheres, num_layers, solver);
    // How far the radius moves when the ball becomes 10 % stiffer: what a recovery has to see.
    SpheresOptions stiffer = spheres;
    stiffer.inner.stiffness_kpa *= 1.1;
    Row row;
    row.set("modulus_kpa", spheres.inner.stiffness_kpa, 1);
    row.set("pressure_kpa", spheres.pressure_kpa, 2);
    row.set("radius_mm", exact, 5);
    row.set("solved_radius_mm", solved, 5);
    row.set("error_percent", 100 * (solved - exact) / (exact - spheres.inner_radius_mm), 3);
    row.set("change_per_10_percent_mm", pressed_inner_radius_mm(stiffer) - exact, 5);
    return row;
}

/// Curves of the closed form over one quantity, one for each value of the other that is in the
/// rows, and the solved radii as marks.
StudyPicture radius_picture(const std::vector<Row>& rows, bool over_modulus) {
    const std::string x_name = over_modulus ? "modulus_kpa" : "pressure_kpa";
    const std::string other_name = over_modulus ? "pressure_kpa" : "modulus_kpa";
    std::set<double> others;
    double lowest = 30;
    for (const Row& row : rows) {
        lowest = std::min(lowest, row.number("radius_mm"));
        const double other = row.number(other_name);
        if (over_modulus || other == 5 || other == 20 || other == 50 || other == 150 ||
            other == 350)
            others.insert(other);
    }
    const PlotAxis x = over_modulus ? PlotAxis{4, 450, true, "E of the ball, kPa"}
                                    : PlotAxis{0, 4.3, false, "pressure outside, kPa"};
    Plot plot(x_name, 440, 340, x, {lowest - 0.5, 30.5, false, "radius of the inner surface, mm"});
    std::vector<LegendEntry> legend;
    for (const double other : others) {
        const std::string& colour = line_colours[legend.size() % line_colours.size()];
        std::vector<double> at, exact, marks, solved;
        for (int k = 0; k <= 60; ++k) {
            at.push_back(over_modulus ? 4 * std::pow(450.0 / 4, k / 60.0) : 4.3 * k / 60);
            exact.push_back(pressed_inner_radius_mm(over_modulus ? spheres_of(at.back(), other)
                                                                 : spheres_of(other, at.back())));
        }
        for (const Row& row : rows) {
            if (row.number(other_name) != other) continue;
            marks.push_back(row.number(x_name));
            solved.push_back(row.number("solved_radius_mm"));
        }
        plot.curve(at, exact, colour, false);
        plot.points(marks, solved, colour, false);
        legend.push_back({fmt::format("{:g} kPa", other), colour});
    }
    return {over_modulus ? "radius-over-modulus" : "radius-over-pressure",
            plot.svg("Radius of the inner surface"), legend_html(legend),
            over_modulus
                ? "Radius over the ball's modulus, by pressure. Lines: closed form; dots: elements."
                : "Radius over the pressure, by modulus. Lines: closed form; dots: elements."};
}

StudyTable sensitivity_table(const std::vector<Row>& rows) {
    StudyTable table{{"E of the ball, kPa", "radius, mm", "elements, mm",
                      "error of the displacement", "moves when 10 % stiffer, mm"},
                     {}};
    for (const Row& row : rows) {
        if (row.number("pressure_kpa") != 1) continue;
        table.lines.push_back({fmt::format("{:g}", row.number("modulus_kpa")),
                               fmt::format("{:.3f}", row.number("radius_mm")),
                               fmt::format("{:.3f}", row.number("solved_radius_mm")),
                               signed_percent(row.number("error_percent")),
                               fmt::format("{:.4f}", row.number("change_per_10_percent_mm"))});
    }
    return table;
}

StudyReport sensitivity_report(const std::vector<Row>& rows) {
    double worst = 0;
    for (const Row& row : rows) worst = std::max(worst, std::abs(row.number("error_percent")));
    const auto change_at = [](double modulus_kpa) {
        const double before = pressed_inner_radius_mm(spheres_of(modulus_kpa, 1));
        return pressed_inner_radius_mm(spheres_of(1.1 * modulus_kpa, 1)) - before;
    };

    StudyReport report;
    report.headline =
        fmt::format("10 % more stiffness moves the surface {:.0f} times less at 350 than at 50 kPa",
                    change_at(50) / change_at(350));
    report.sentences = {
        "A ball of 30 mm sticks to a shell of 37.5 mm and 10 kPa that is pressed from outside; "
        "Poisson's ratio is 0.40 inside and 0.35 outside. The radius between them is all that a "
        "recovery sees of the ball's stiffness: the flatter the curve, the more noise weighs.",
        fmt::format("Elements and closed form differ by at most {:.2f} % of the displacement.",
                    worst)};
    report.sections = {
        {"Radius of the inner surface",
         sensitivity_table(rows).html("beside") +
             "<p class='caption'>At a pressure of 1 kPa. The scene is that of Lee, Foskey, "
             "Niethammer, Krajcevski and Lin, who show the radius against modulus and "
             "force.</p>",
         {radius_picture(rows, true), radius_picture(rows, false)}}};
    report.facts = {{"worst_error_percent", worst},
                    {"moves_less_at_350_than_at_50", change_at(50) / change_at(350)}};
    report.text = sensitivity_table(rows).plain();
    return report;
}

}  // namespace

Study make_sensitivity_study(const StudyOptions& options) {
    Study study{"sensitivity",
                "How much of a ball's stiffness its surface shows",
                {{"layers", fmt::format("{}", num_layers)}},
                {"modulus_kpa", "pressure_kpa", "radius_mm", "solved_radius_mm", "error_percent",
                 "change_per_10_percent_mm"},
                {},
                sensitivity_report};
    for (const double pressure : pressures_kpa)
        for (const double modulus : moduli_kpa)
            study.cases.push_back({fmt::format("e{:g}-p{:g}", modulus, pressure),
                                   fmt::format("{:g} kPa, pressure {:g} kPa", modulus, pressure),
                                   [=, solver = options.solver](const ProgressSink&) {
                                       return solve(spheres_of(modulus, pressure), solver);
                                   }});
    return study;
}

}  // namespace palpate
