// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/published.hpp"
#include "host/apps/study/studies.hpp"
#include "host/apps/study/sucked_scene.hpp"
#include "host/apps/study/tables.hpp"
#include "host/estimate/fit.hpp"
#include "host/io/files.hpp"
#include "host/page/plot.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double sd_mm = 0.02;
constexpr double true_kappa_kpa = 1e4, hardly_compressible_kpa = 1e5;
// of tissue that sticks as well: heights differ by 1 um at most. It has an equilibrium with sharp
// edges, where `stick_friction` has none
constexpr double enough_friction = 3, sharp_edge_mm = 0.1;
constexpr double less_friction = 1;  // which slips a little
constexpr int edge_refine = 2;       // coarser cells at the edge move mu by 1.5 % more

/// A law of Veronda and Westmann with one relaxation term.
struct Tissue {
    double mu_kpa, gamma, amplitude, time_s;
    static constexpr std::array<const char*, 4> names{"mu_kpa", "gamma", "amplitude", "time_s"};
    std::array<double, 4> values() const { return {mu_kpa, gamma, amplitude, time_s}; }
};
constexpr Tissue published_sliding{0.693, 12.0, 0.41, 4.7},
    published_sticking{0.7, 10.5, 0.44, 4.8};
constexpr Tissue begin{1.0, 10.0, 0.4, 4.0};  // of the searches

TissueText text_of(const Tissue& tissue, bool is_open) {
    const auto number = [&](double value) {
        return is_open ? open_from(value) : fmt::format("{:.10g}", value);
    };
    return {"veronda-westmann",
            {{"mu_kpa", number(tissue.mu_kpa)}, {"gamma", number(tissue.gamma)}},
            {{number(tissue.amplitude), number(tissue.time_s)}}};
}

/// The experiment in which only the tissue is looked for, by least squares.
Fit fit_least_squares(const Experiment& experiment, const ProgressSink& progress) {
    // 300 quadrilaterals: as the host solves them by default
    const ExperimentProblem problem(
        experiment, [](SimulationSettings&) {}, 1, progress);
    FitOptions options;
    options.noise.huber_sd = std::numeric_limits<double>::infinity();
    options.discrepancy.is_learned = false;
    return fit(problem, options, progress);
}

/// What is found of tissue whose body is one thing and is taken for another.
Row run_case(const Tissue& tissue, const SuckedScene& truth, const SuckedScene& assumed,
             const ProgressSink& progress) {
    AspirationBody body = truth.body();
    body.tissue = text_of(tissue, false);
    const auto surface = sucked_surface(body, 0, progress);
    if (!surface)
        throw Error(ErrorCode::solve_failed, "the sucked body has no equilibrium; please report");
    AspirationBody taken = assumed.body();
    taken.tissue = text_of(begin, true);
    const PrivateFolder folder;
    write_sucked_points(
        *surface, body.steps, sd_mm, [] { return 0.0; }, folder.path());
    const Experiment experiment = sucked_experiment(taken, folder.path());
    const Fit found = fit_least_squares(experiment, progress);

    Row row;
    row.set("true_kappa_kpa", truth.kappa_kpa, 0);
    row.set("kappa_kpa", assumed.kappa_kpa, 0);
    row.set("true_friction", truth.friction, 1);
    row.set("edge_radius_mm", assumed.edge_radius_mm, 3);
    for (std::size_t k = 0; k < experiment.paths().size(); ++k)
        for (std::size_t n = 0; n < Tissue::names.size(); ++n)
            if (experiment.paths()[k].ends_with(std::string(".") + Tissue::names[n])) {
                row.set(fmt::format("true_{}", Tissue::names[n]), tissue.values()[n], 4);
                row.set(Tissue::names[n], found.values[Eigen::Index(k)], 4);
            }
    const DataBlock& block = found.prediction->blocks.front();
    const double rms_mm =
        (block.measured - block.predicted).norm() / std::sqrt(double(block.num_row()));
    row.set("rms_um", 1000 * rms_mm, 2);
    row.set("travel_mm", surface->travel_mm(), 3);
    row.set_flag("converged", found.ending == Ending::converged);
    return row;
}

std::vector<std::string> columns() {
    std::vector<std::string> names{"true_kappa_kpa", "kappa_kpa", "true_friction",
                                   "edge_radius_mm"};
    for (const char* name : Tissue::names) {
        names.push_back(fmt::format("true_{}", name));
        names.emplace_back(name);
    }
    names.insert(names.end(), {"rms_um", "travel_mm", "converged"});
    return names;
}

double error_percent(const Row& row, const std::string& name) {
    return 100 * (row.number(name) / row.number("true_" + name) - 1);
}

/// What a row is called in a table or a fact.
using Label = std::function<std::string(const Row&)>;

/// What was published of a bulk modulus, as cells; dashes where nothing was.
std::vector<std::string> published_cells(double kappa_kpa,
                                         const std::vector<PublishedSuckedTissue>& published) {
    for (const PublishedSuckedTissue& one : published)
        if (one.kappa_kpa == kappa_kpa)
            return {fmt::format("{:g}", one.mu_kpa), fmt::format("{:g}", one.gamma),
                    fmt::format("{:g}", one.amplitude), fmt::format("{:g}", one.time_s)};
    return std::vector<std::string>(published.empty() ? 0 : 4, "–");
}

/// A line for each row: what was found with its error, what is left unexplained, and beside it what
/// was published, if anything.
StudyTable found_table(const std::vector<Row>& rows, const Label& label, const std::string& title,
                       const std::vector<PublishedSuckedTissue>& published) {
    StudyTable table{{title, "mu, kPa", "gamma", "C", "tau, s", "left unexplained, um"}, {}};
    if (!published.empty()) {
        table.header.insert(table.header.end(), {"mu, kPa", "gamma", "C", "tau, s"});
        table.groups = {{"found (error)", 5}, {"published, of a measurement", 4}};
    }
    for (const Row& row : rows) {
        std::vector<std::string> line{label(row)};
        for (const char* name : Tissue::names)
            line.push_back(fmt::format("{:.3g} ({})", row.number(name),
                                       signed_percent(error_percent(row, name))));
        line.push_back(fmt::format("{:.1f}", row.number("rms_um")));
        const auto cells = published_cells(row.number("kappa_kpa"), published);
        line.insert(line.end(), cells.begin(), cells.end());
        table.lines.push_back(line);
    }
    return table;
}

StudyPicture error_curves(const std::vector<Row>& rows, const std::string& key, PlotAxis x) {
    double lowest = -5, highest = 5;
    for (const Row& row : rows)
        for (const char* name : Tissue::names) {
            lowest = std::min(lowest, error_percent(row, name) - 5);
            highest = std::max(highest, error_percent(row, name) + 5);
        }
    Plot plot("errors", 440, 300, std::move(x), {lowest, highest, false, "error, %"});
    static constexpr std::array<const char*, 4> colours{our_colour, published_colour, "#009e73",
                                                        "#cc79a7"};
    static constexpr std::array<const char*, 4> words{"mu", "gamma", "C", "tau"};
    std::vector<LegendEntry> legend;
    for (std::size_t n = 0; n < Tissue::names.size(); ++n) {
        std::vector<double> at, error;
        for (const Row& row : rows) {
            at.push_back(row.number(key));
            error.push_back(error_percent(row, Tissue::names[n]));
        }
        plot.curve(at, error, colours[n], false);
        plot.points(at, error, colours[n], false);
        legend.push_back({words[n], colours[n]});
    }
    return {"errors", plot.svg("Errors of the four numbers"), legend_html(legend),
            "Error of each number where only the assumption is wrong: data have no noise, mesh and "
            "time steps are those of the fit."};
}

std::string scene_sentence() {
    return std::string(SuckedScene::sentence()) +
           " Suction is 100 mbar, the tissue a law of Veronda and Westmann with one relaxation "
           "term; its numbers are looked for by least squares of the heights.";
}

double worst_error(const std::vector<Row>& rows) {
    double worst = 0;
    for (const Row& row : rows)
        for (const char* name : Tissue::names)
            worst = std::max(worst, std::abs(error_percent(row, name)));
    return worst;
}

void add_facts(const std::vector<Row>& rows, const Label& label, StudyReport& report) {
    for (const Row& row : rows) {
        for (const char* name : Tissue::names)
            report.facts.emplace_back(fmt::format("{}.{}_error_percent", label(row), name),
                                      error_percent(row, name));
        report.facts.emplace_back(label(row) + ".rms_um", row.number("rms_um"));
    }
}

std::vector<Row> rows_where(const std::vector<Row>& rows, const std::string& name, double value) {
    std::vector<Row> some;
    for (const Row& row : rows)
        if (row.number(name) == value) some.push_back(row);
    return some;
}

std::string kappa_label(const Row& row) {
    return fmt::format("{:g} for {:g}", row.number("kappa_kpa"), row.number("true_kappa_kpa"));
}

StudyReport kappa_report(const std::vector<Row>& rows) {
    StudyReport report;
    const std::vector<Row> usual = rows_where(rows, "true_kappa_kpa", true_kappa_kpa);
    report.headline =
        fmt::format("A bulk modulus that is assumed too small makes errors of up to {:.0f} %",
                    worst_error(rows));
    report.sentences = {
        scene_sentence(),
        "Data are of tissue with a bulk modulus of 10 MPa, which hardly changes its volume; fits "
        "take it for less. One more has 100 MPa and is fitted with what aspirate fit assumes.",
        fmt::format("The stiffness at the peak is {:.1f} kPa, of which aspirate fit takes {:g} "
                    "times.",
                    SuckedScene().stiffness_kpa(), usual_kappa_over_young)};
    const StudyTable table = found_table(rows, kappa_label, "bulk modulus, assumed for true, kPa",
                                         published_sucked_tissue());
    report.sections = {
        {"What a bulk modulus does",
         table.html("beside") + "<p class='caption'>" + published_sucked_tissue_source() + "</p>",
         {error_curves(usual, "kappa_kpa", {50, 2e4, true, "assumed bulk modulus, kPa"})}}};
    add_facts(
        rows,
        [](const Row& row) {
            return fmt::format("kappa_kpa_{:g}_for_{:g}", row.number("kappa_kpa"),
                               row.number("true_kappa_kpa"));
        },
        report);
    report.text = table.plain();
    return report;
}

std::string friction_label(const Row& row) {
    return fmt::format("{:g}, friction {:g}", row.number("edge_radius_mm"),
                       row.number("true_friction"));
}

/// Ascending in the edge's radius.
std::vector<Row> sticking_rows(const std::vector<Row>& rows) {
    std::vector<Row> some;
    for (const Row& row : rows)
        if (row.number("true_friction") >= enough_friction) some.push_back(row);
    return some;
}

StudyReport friction_report(const std::vector<Row>& rows) {
    StudyReport report;
    const std::vector<Row> sticking = sticking_rows(rows);
    report.headline = fmt::format(
        "Tissue that sticks to the tube and is taken to slide is wrong by up to {:.0f} %",
        worst_error(sticking));
    report.sentences = {
        scene_sentence(),
        fmt::format("Data are of tissue that sticks to the rim (friction {:g}, as in aspirate "
                    "fit; {:g} with edges of 0.05 and {:g} mm, where {:g} has no equilibrium), "
                    "fits let it slide, for edges of several radii, which fits know. Beside it "
                    "friction {:g}.",
                    stick_friction, enough_friction, sharp_edge_mm, stick_friction, less_friction),
        "Published, of one measurement: gamma 12.0 sliding and 10.5 sticking (+14 %), mu 0.693 "
        "and 0.700 kPa (-1 %), C 0.41 and 0.44, tau 4.7 and 4.8 s."};
    const StudyTable table = found_table(rows, friction_label, "radius of the edge, mm", {});
    report.sections = {
        {"What friction does",
         table.html("beside") + "<p class='caption'>" + published_sucked_tissue_source() + "</p>",
         {error_curves(sticking, "edge_radius_mm", {0, 0.5, false, "radius of the edge, mm"})}}};
    add_facts(
        rows,
        [](const Row& row) {
            return fmt::format("edge_radius_mm_{:g}_friction_{:g}", row.number("edge_radius_mm"),
                               row.number("true_friction"));
        },
        report);
    report.text = table.plain();
    return report;
}

StudyCase kappa_case(double true_kpa, double assumed_kpa) {
    return {fmt::format("kappa-{:.0f}-for-{:.0f}", assumed_kpa, true_kpa),
            fmt::format("bulk modulus {:.0f} for {:.0f} kPa", assumed_kpa, true_kpa),
            [=](const ProgressSink& progress) {
                return run_case(published_sliding, {.kappa_kpa = true_kpa},
                                {.kappa_kpa = assumed_kpa}, progress);
            }};
}

StudyCase friction_case(double friction, double edge_mm) {
    return {fmt::format("friction-{:g}-edge-{:g}", friction, edge_mm),
            fmt::format("friction {:g}, edge of {:g} mm", friction, edge_mm),
            [=](const ProgressSink& progress) {
                return run_case(
                    published_sticking,
                    {.edge_radius_mm = edge_mm, .friction = friction, .refine = edge_refine},
                    {.edge_radius_mm = edge_mm, .refine = edge_refine}, progress);
            }};
}

}  // namespace

Study make_aspiration_kappa_study(const StudyOptions&) {
    Study study{
        "aspiration-kappa",
        "What the bulk modulus that is assumed does to sucked tissue",
        {{"steps", fmt::format("{}", SuckedScene().num_steps)},
         {"true kPa", fmt::format("{:g} and {:g}", true_kappa_kpa, hardly_compressible_kpa)}},
        columns(),
        {},
        kappa_report};
    for (const double kappa_kpa : {true_kappa_kpa, 1e3, 1e2})
        study.cases.push_back(kappa_case(true_kappa_kpa, kappa_kpa));
    study.cases.push_back(kappa_case(hardly_compressible_kpa,
                                     usual_kappa_over_young * SuckedScene().stiffness_kpa()));
    return study;
}

Study make_aspiration_friction_study(const StudyOptions&) {
    Study study{"aspiration-friction",
                "Tissue that sticks to the tube and is taken to slide",
                {{"steps", fmt::format("{}", SuckedScene().num_steps)},
                 {"friction",
                  fmt::format("{:g}, {:g}, {:g}", stick_friction, enough_friction, less_friction)}},
                columns(),
                {},
                friction_report};
    for (const double edge_mm : {0.05, 0.1, 0.2, 0.4})
        study.cases.push_back(
            friction_case(edge_mm <= sharp_edge_mm ? enough_friction : stick_friction, edge_mm));
    for (const double edge_mm : {0.05, 0.1, 0.2, 0.4})
        study.cases.push_back(friction_case(less_friction, edge_mm));
    return study;
}

}  // namespace palpate
