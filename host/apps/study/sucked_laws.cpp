// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/phantom/random_numbers.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/studies.hpp"
#include "host/apps/study/sucked_scene.hpp"
#include "host/apps/study/tables.hpp"
#include "host/estimate/fit.hpp"
#include "host/estimate/identified.hpp"
#include "host/io/files.hpp"
#include "host/page/plot.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr const char* soft_law = "neo-hookean-reduced";
const std::vector<std::string>& laws() {
    static const std::vector<std::string> names{soft_law, "veronda-westmann", "reduced-polynomial"};
    return names;
}
constexpr int most_terms = 2;
constexpr double noise_mm = 0.005;
constexpr int most_tries = 5;
// e^(gamma x) is how much stiffer tissue is at the peak, x = 1.3 (travel / hole radius)^2
constexpr double stretch_factor = 1.3;
constexpr double start_gamma = 8, start_amplitude = 0.5, start_time_s = 2;
constexpr double stiff_side = 1.3;  // searches begin there

/// What is sucked, drawn from a seed.
struct TrueTissue {
    std::string law;
    double mu_kpa = 0, gamma = 0, peak_kpa = 0;
    std::vector<std::pair<double, double>> terms;  ///< amplitude, time
};

/// Theret's formula the other way round: what it takes to suck tissue by `travel_mm`.
double suction_for(double stiffness_kpa, double travel_mm) {
    return stiffness_kpa / theret_stiffness(1, SuckedScene::hole_radius_mm, travel_mm);
}

double stretch_at(double travel_mm) {
    return stretch_factor * std::pow(travel_mm / SuckedScene::hole_radius_mm, 2);
}

TrueTissue draw_tissue(unsigned seed) {
    RandomNumbers random(0x5c0ffULL + seed);
    const auto evenly_in_ln = [&](double low, double high) {
        return std::exp(random.uniform(std::log(low), std::log(high)));
    };
    TrueTissue tissue;
    tissue.law = laws()[random.is_below(0.5) ? 1 : 2];
    tissue.mu_kpa = evenly_in_ln(0.2, 5);
    tissue.gamma = evenly_in_ln(3, 25);
    const double first_s = evenly_in_ln(0.5, 5);
    tissue.terms = {{random.uniform(0.2, 0.8), first_s}};
    if (random.is_below(0.5)) tissue.terms.emplace_back(random.uniform(0.2, 0.8), 5 * first_s);
    const double travel_mm = random.uniform(1, 1.6);
    // E = 6 mu e^(gamma x)
    tissue.peak_kpa =
        suction_for(6 * tissue.mu_kpa * std::exp(tissue.gamma * stretch_at(travel_mm)), travel_mm);
    return tissue;
}

/// A law by its shear modulus and how fast it stiffens: c2 of reduced-polynomial is mu gamma / 2.
TissueText law_text(const std::string& law, double mu_kpa, double gamma,
                    const std::vector<std::pair<double, double>>& terms, bool is_open) {
    const auto number = [&](double value) {
        return is_open ? open_from(value) : fmt::format("{:.10g}", value);
    };
    TissueText text{law, {}, {}};
    if (law == "reduced-polynomial")
        text.parameters = {{"c1_kpa", number(mu_kpa)}, {"c2_kpa", number(0.5 * mu_kpa * gamma)}};
    else
        text.parameters = {{"mu_kpa", number(mu_kpa)}};
    if (law == "veronda-westmann") text.parameters.emplace_back("gamma", number(gamma));
    for (const auto& [amplitude, time_s] : terms)
        text.relaxation.emplace_back(number(amplitude), number(time_s));
    return text;
}

/// Where a search begins, told by the travel alone, on the stiff side.
TissueText start_of(const std::string& law, int num_terms, double peak_kpa, double travel_mm) {
    const double stiffness_kpa = theret_stiffness(peak_kpa, SuckedScene::hole_radius_mm, travel_mm);
    const double softer = law == soft_law ? 1 : std::exp(start_gamma * stretch_at(travel_mm));
    std::vector<std::pair<double, double>> terms;
    for (int k = 0; k < num_terms; ++k)
        terms.emplace_back(start_amplitude / num_terms,
                           num_terms == 1 ? start_time_s : start_time_s * (k == 0 ? 0.4 : 2.5));
    return law_text(law, stiff_side * stiffness_kpa / (6 * softer), start_gamma, terms, true);
}

/// Of one law with so many relaxation terms; minus infinity where it was not fitted.
double log_evidence(const SuckedScene& scene, const TissueText& start,
                    const std::filesystem::path& folder, const ProgressSink& progress) {
    AspirationBody body = scene.body();
    body.tissue = start;
    const Experiment experiment = sucked_experiment(body, folder);
    const ExperimentProblem problem(
        experiment, [](SimulationSettings&) {}, 1, progress);
    try {
        const Fit found = fit(problem, {}, progress);
        // neither profiles nor far ends: they say nothing of the evidence
        const IdentifyOptions options{{}, std::numeric_limits<double>::infinity(), false};
        return identify(problem, found, options, progress).log_evidence;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        return -std::numeric_limits<double>::infinity();
    }
}

std::string model_name(const std::string& law, int num_terms) {
    return fmt::format("{}, {}", law, num_terms);
}

Row recover_law(unsigned seed, const ProgressSink& progress) {
    TrueTissue truth = draw_tissue(seed);
    SuckedScene scene;
    std::optional<SuckedSurface> surface;
    for (int k = 0; !surface && k < most_tries; ++k, truth.peak_kpa *= 0.8) {
        scene.peak_kpa = truth.peak_kpa;
        AspirationBody body = scene.body();
        body.tissue = law_text(truth.law, truth.mu_kpa, truth.gamma, truth.terms, false);
        surface = sucked_surface(body, 0, progress);
    }
    if (!surface) throw Error(ErrorCode::solve_failed, "this seed's tissue has no equilibrium");
    RandomNumbers noise(0xab5e11ULL + seed);
    const PrivateFolder folder;
    write_sucked_points(
        *surface, scene.body().steps, noise_mm, [&] { return noise_mm * noise.normal(); },
        folder.path());
    Row row;
    row.set("true_law", truth.law);
    row.set("true_terms", double(truth.terms.size()), 0);
    row.set("mu_kpa", truth.mu_kpa, 3);
    row.set("gamma", truth.gamma, 2);
    row.set("travel_mm", surface->travel_mm(), 2);
    double best = -std::numeric_limits<double>::infinity();
    for (const std::string& law : laws())
        for (int terms = 0; terms <= most_terms; ++terms) {
            const double evidence =
                log_evidence(scene, start_of(law, terms, scene.peak_kpa, surface->travel_mm()),
                             folder.path(), progress);
            row.set(model_name(law, terms), evidence, 1);
            if (!(evidence > best)) continue;
            best = evidence;
            row.set("best_law", law);
            row.set("best_terms", terms, 0);
        }
    return row;
}

std::vector<std::string> law_columns() {
    std::vector<std::string> names{"true_law",  "true_terms", "mu_kpa",    "gamma",
                                   "travel_mm", "best_law",   "best_terms"};
    for (const std::string& law : laws())
        for (int terms = 0; terms <= most_terms; ++terms) names.push_back(model_name(law, terms));
    return names;
}

/// ln evidence of the best model of a law.
double best_of_law(const Row& row, const std::string& law) {
    double best = -std::numeric_limits<double>::infinity();
    for (int terms = 0; terms <= most_terms; ++terms) {
        const double evidence = row.number(model_name(law, terms));
        if (evidence > best) best = evidence;  // not a NaN
    }
    return best;
}

struct Counts {
    int law = 0, terms = 0, both = 0, rejected = 0, clear = 0, clear_and_right = 0;
};
constexpr double clear_lead = 3;  // of ln evidence: 20 to 1

/// ln evidence of the right law's best model over that of the other stiffening law's.
double lead_of(const Row& row) {
    const bool is_second = row.text("true_law") == laws()[1];
    return best_of_law(row, laws()[is_second ? 1 : 2]) -
           best_of_law(row, laws()[is_second ? 2 : 1]);
}

Counts counts_of(const std::vector<Row>& rows) {
    Counts counts;
    for (const Row& row : rows) {
        const bool law = row.text("best_law") == row.text("true_law");
        const bool terms = row.number("best_terms") == row.number("true_terms");
        counts.law += law;
        counts.terms += terms;
        counts.both += law && terms;
        counts.rejected +=
            best_of_law(row, soft_law) <
            std::max(best_of_law(row, laws()[1]), best_of_law(row, laws()[2])) - clear_lead;
        if (std::abs(lead_of(row)) < clear_lead) continue;
        ++counts.clear;
        counts.clear_and_right += lead_of(row) > 0;
    }
    return counts;
}

StudyPicture lead_picture(const std::vector<Row>& rows) {
    Plot plot("lead", 440, 300, {2.5, 30, true, "gamma: how fast the tissue stiffens"},
              {-2, 4, false, "decades of odds of the right law"});
    std::vector<double> at, lead, wrong_at, wrong;
    for (const Row& row : rows) {
        // odds as powers of ten, cut where the axis ends
        const double decades = std::clamp(lead_of(row) / std::log(10.0), -1.9, 3.9);
        (decades > 0 ? at : wrong_at).push_back(row.number("gamma"));
        (decades > 0 ? lead : wrong).push_back(decades);
    }
    plot.points(at, lead, our_colour, false);
    plot.points(wrong_at, wrong, miss_colour, false);
    return {"lead", plot.svg("Odds of the right law against the other stiffening law"),
            legend_html({{"right law first", our_colour}, {"wrong law first", miss_colour}}),
            "Odds of the right law's best model against the other stiffening law's, as powers of "
            "ten (beyond 4: drawn there). Near 0 the data do not tell the laws apart."};
}

StudyReport laws_report(const std::vector<Row>& rows) {
    const Counts counts = counts_of(rows);
    const std::size_t n = rows.size();
    StudyTable table{{"what", "of all"}, {}};
    const auto add = [&](const std::string& what, int number, std::size_t of) {
        table.lines.push_back({what, fmt::format("{} of {}", number, of)});
    };
    add("right law first", counts.law, n);
    add("right number of relaxation terms first", counts.terms, n);
    add("both", counts.both, n);
    add("neo-Hookean rejected (20 to 1)", counts.rejected, n);
    add("laws told apart (20 to 1), of these the right one first", counts.clear_and_right,
        std::size_t(counts.clear));
    StudyReport report;
    report.headline = fmt::format(
        "The right law is first in {} of {}, with the right number of "
        "relaxation terms in {}",
        counts.law, n, counts.both);
    report.sentences = {
        std::string(SuckedScene::sentence()) +
            fmt::format(" Its tissue follows one of two laws that stiffen, with one or two "
                        "relaxation terms, drawn from the seed; heights have noise of {:g} um. "
                        "Neo-Hookean and both laws are fitted with none to {} terms, and compared "
                        "by their evidence.",
                        1000 * noise_mm, most_terms),
        "The instrument is known, and cells and time steps of the fit are those of the truth: "
        "films know less."};
    report.sections = {{"Which law comes first", table.html(), {lead_picture(rows)}}};
    report.facts = {{"cases", double(n)},
                    {"law_right", counts.law},
                    {"terms_right", counts.terms},
                    {"both_right", counts.both},
                    {"neo_hookean_rejected", counts.rejected},
                    {"told_apart", counts.clear},
                    {"told_apart_and_right", counts.clear_and_right}};
    report.text = table.plain();
    return report;
}

}  // namespace

Study make_aspiration_laws_study(const StudyOptions& options) {
    Study study{"aspiration-laws",
                "Which law sucked tissue follows, told by the evidence",
                {{"first seed", fmt::format("{}", options.first_seed)},
                 {"noise, mm", fmt::format("{}", noise_mm)}},
                law_columns(),
                {},
                laws_report};
    for (int k = 0; k < options.phantoms; ++k) {
        const unsigned seed = options.first_seed + unsigned(k);
        study.cases.push_back(
            {fmt::format("seed-{}", seed), fmt::format("seed {}", seed),
             [seed](const ProgressSink& progress) { return recover_law(seed, progress); }});
    }
    return study;
}

}  // namespace palpate
