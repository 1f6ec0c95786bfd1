// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/identify/more_terms.hpp"
#include "host/apps/phantom/random_numbers.hpp"
#include "host/apps/study/drawn_tissue.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/studies.hpp"
#include "host/apps/study/sucked_scene.hpp"
#include "host/apps/study/tables.hpp"
#include "host/estimate/fit.hpp"
#include "host/estimate/identified.hpp"
#include "host/estimate/model_choice.hpp"
#include "host/io/files.hpp"
#include "host/page/plot.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr const char* soft_law = "neo-hookean-reduced";
const std::vector<std::string>& laws() {
    static const std::vector<std::string> names{soft_law, exponential_law, polynomial_law};
    return names;
}
constexpr int most_terms = 2;
constexpr double noise_mm = 0.005;
constexpr int most_tries = 5;
/// Of ln posterior, as where films are fitted: a hundredth of what tells laws apart.
constexpr double gain_at_end = 0.05, keeps_columns_at_end = 1;

/// Where a search begins: stiffness over what the travel tells, and the rest of its numbers.
struct Begin {
    double stiff_side, gamma, amplitude, time_s;
};
/// The second is for searches that do not end well from the first.
constexpr std::array<Begin, 2> begins{{{1.3, 8, 0.5, 2}, {2, 4, 0.3, 4}}};

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
TissueText start_of(const std::string& law, int num_terms, double peak_kpa, double travel_mm,
                    const Begin& begin) {
    const double stiffness_kpa = theret_stiffness(peak_kpa, SuckedScene::hole_radius_mm, travel_mm);
    const double at_rest_kpa = stiffness_kpa / stiffening(law, begin.gamma, travel_mm);
    std::vector<std::pair<double, double>> terms;
    for (int k = 0; k < num_terms; ++k)
        terms.emplace_back(begin.amplitude / num_terms,
                           num_terms == 1 ? begin.time_s : begin.time_s * (k == 0 ? 0.4 : 2.5));
    return law_text(law, begin.stiff_side * at_rest_kpa / 6, begin.gamma, terms, true);
}

/// How the search of one law with so many relaxation terms ended.
struct TriedLaw {
    std::string ending;
    std::optional<double> log_evidence = {};  ///< where that can be used
    std::shared_ptr<const Experiment> experiment = {};
    Fit found = {};
};

/// A start where that with fewer terms ended.
void begin_at(const TriedLaw& simpler, const Experiment& experiment, FitOptions& searching) {
    searching.start = start_with_more_terms(*simpler.experiment, simpler.found.values, experiment);
    searching.warm = guess_for(*simpler.found.prediction, searching.start);
    searching.discrepancy.given = {simpler.found.noise->discrepancy(0)};
}

/// Begins at `start`, or where a simpler one that is not null ended.
TriedLaw try_law(const SuckedScene& scene, const TissueText& start, const TriedLaw* simpler,
                 const std::filesystem::path& folder, const ProgressSink& progress) {
    AspirationBody body = scene.body();
    body.tissue = start;
    TriedLaw tried;
    tried.experiment = std::make_shared<const Experiment>(sucked_experiment(body, folder));
    const ExperimentProblem problem(
        *tried.experiment, [](SimulationSettings&) {}, 1, progress);
    try {
        FitOptions searching;
        searching.gauss_newton.gain_tolerance = gain_at_end;
        searching.gauss_newton.keeps_columns_within = keeps_columns_at_end;
        if (simpler) begin_at(*simpler, *tried.experiment, searching);
        tried.found = fit(problem, searching, progress);
        tried.ending = tried.found.is_settled ? name_of(tried.found.ending) : "noise not settled";
        // neither profiles nor far ends: they say nothing of the evidence
        const IdentifyOptions options{{}, std::numeric_limits<double>::infinity(), false};
        if (tried.found.is_usable())
            tried.log_evidence = identify(problem, tried.found, options, progress).log_evidence;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        tried.ending = "no equilibrium";
    }
    return tried;
}

/// From the end of the law with a term less, and where that does not end well, from elsewhere.
TriedLaw try_all_starts(const SuckedScene& scene, const SuckedSurface& surface,
                        const std::string& law, int terms, const TriedLaw& simpler,
                        const std::filesystem::path& folder, const ProgressSink& progress) {
    const auto start = [&](const Begin& begin) {
        return start_of(law, terms, scene.peak_kpa, surface.travel_mm(), begin);
    };
    TriedLaw tried;
    if (terms > 1 && simpler.log_evidence)
        tried = try_law(scene, start(begins.front()), &simpler, folder, progress);
    for (std::size_t k = 0; k < begins.size() && !tried.log_evidence; ++k)
        tried = try_law(scene, start(begins[k]), nullptr, folder, progress);
    return tried;
}

std::string model_name(const std::string& law, int num_terms) {
    return fmt::format("{}, {}", law, num_terms);
}
std::string ending_name(const std::string& law, int num_terms) {
    return model_name(law, num_terms) + ": search";
}

/// The truth's surface, with less suction than was drawn where that has no equilibrium.
SuckedSurface suck(const DrawnTissue& truth, SuckedScene& scene, const ProgressSink& progress) {
    scene.kappa_kpa = truth.kappa_kpa;
    scene.peak_kpa = truth.peak_kpa;
    for (int k = 0; k < most_tries; ++k, scene.peak_kpa *= 0.8) {
        AspirationBody body = scene.body();
        body.tissue = law_text(truth.law, truth.mu_kpa, truth.gamma, truth.terms, false);
        if (auto surface = sucked_surface(body, 0, progress)) return *std::move(surface);
    }
    throw Error(ErrorCode::solve_failed, "this seed's tissue has no equilibrium");
}

Row row_of(const DrawnTissue& truth, const SuckedScene& scene, const SuckedSurface& surface) {
    Row row;
    row.set("true_law", truth.law);
    row.set("true_terms", double(truth.terms.size()), 0);
    row.set("mu_kpa", truth.mu_kpa, 3);
    row.set("gamma", truth.gamma, 2);
    row.set("kappa_kpa", truth.kappa_kpa, 0);
    row.set("peak_mbar", scene.peak_kpa / kpa_per_mbar, 0);
    row.set("travel_mm", surface.travel_mm(), 2);
    return row;
}

Row recover_law(unsigned seed, const ProgressSink& progress) {
    const DrawnTissue truth = draw_tissue(seed);
    SuckedScene scene;
    const SuckedSurface surface = suck(truth, scene, progress);
    RandomNumbers noise(0xab5e11ULL + seed);
    const PrivateFolder folder;
    write_sucked_points(
        surface, scene.body().steps, noise_mm, [&] { return noise_mm * noise.normal(); },
        folder.path());
    Row row = row_of(truth, scene, surface);
    double best = -std::numeric_limits<double>::infinity();
    for (const std::string& law : laws()) {
        TriedLaw tried;
        for (int terms = 0; terms <= most_terms; ++terms) {
            tried = try_all_starts(scene, surface, law, terms, tried, folder.path(), progress);
            row.set(ending_name(law, terms), tried.ending);
            if (!tried.log_evidence) continue;
            row.set(model_name(law, terms), *tried.log_evidence, 1);
            if (!(*tried.log_evidence > best)) continue;
            best = *tried.log_evidence;
            row.set("best_law", law);
            row.set("best_terms", terms, 0);
        }
    }
    return row;
}

std::vector<std::string> law_columns() {
    std::vector<std::string> names{"true_law",  "true_terms", "mu_kpa",   "gamma",     "kappa_kpa",
                                   "peak_mbar", "travel_mm",  "best_law", "best_terms"};
    for (const std::string& law : laws())
        for (int terms = 0; terms <= most_terms; ++terms) {
            names.push_back(model_name(law, terms));
            names.push_back(ending_name(law, terms));
        }
    return names;
}

/// Whether the search of this model ended well; only then is its ln evidence there.
bool is_usable(const Row& row, const std::string& law, double terms) {
    return std::isfinite(row.number(model_name(law, int(terms))));
}

/// ln evidence of the best usable model of a law; minus infinity where there is none.
double best_of_law(const Row& row, const std::string& law) {
    double best = -std::numeric_limits<double>::infinity();
    for (int terms = 0; terms <= most_terms; ++terms)
        if (is_usable(row, law, terms)) best = std::max(best, row.number(model_name(law, terms)));
    return best;
}

/// What comes first (`preferred_model`); empty where there is no usable model.
std::pair<std::string, int> first_of(const Row& row) {
    std::vector<std::pair<std::string, int>> names;
    std::vector<ModelCandidate> candidates;
    for (const std::string& law : laws())
        for (int terms = 0; terms <= most_terms; ++terms) {
            if (!is_usable(row, law, terms)) continue;
            names.emplace_back(law, terms);
            candidates.push_back(
                {row.number(model_name(law, terms)), 2 * terms + (law == soft_law ? 1 : 2)});
        }
    if (candidates.empty()) return {};
    return names[preferred_model(candidates)];
}

/// How often what was right came first, and in how many rows there was something to compare: a law
/// is beaten only with the right number of terms, a number of terms only in the right law, and only
/// where its search ended well.
struct Counts {
    int law = 0, terms = 0, both = 0, rejected = 0, clear = 0, clear_and_right = 0;
    int of_law = 0, of_terms = 0, of_both = 0, of_rejected = 0;
    int models = 0, unusable = 0;
};
constexpr double clear_lead = 3;  // of ln evidence: 20 to 1

bool tells_laws(const Row& row) {
    const double terms = row.number("true_terms");
    return is_usable(row, exponential_law, terms) && is_usable(row, polynomial_law, terms);
}

bool tells_terms(const Row& row) {
    for (int terms = 1; terms <= most_terms; ++terms)
        if (!is_usable(row, row.text("true_law"), terms)) return false;
    return true;
}

/// ln evidence of the right law's best model over that of the other stiffening law's; for rows that
/// tell laws.
double lead_of(const Row& row) {
    const double lead = best_of_law(row, exponential_law) - best_of_law(row, polynomial_law);
    return row.text("true_law") == exponential_law ? lead : -lead;
}

void count_neo_hookean(const Row& row, Counts& counts) {
    const double stiffening_law =
        std::max(best_of_law(row, exponential_law), best_of_law(row, polynomial_law));
    if (!is_usable(row, soft_law, row.number("true_terms")) || !std::isfinite(stiffening_law))
        return;
    ++counts.of_rejected;
    counts.rejected += best_of_law(row, soft_law) < stiffening_law - clear_lead;
}

void count_row(const Row& row, Counts& counts) {
    const auto [first_law, first_terms] = first_of(row);
    const bool law = first_law == row.text("true_law");
    const bool terms = first_terms == int(row.number("true_terms"));
    counts.of_law += tells_laws(row);
    counts.of_terms += tells_terms(row);
    counts.of_both += tells_laws(row) && tells_terms(row);
    counts.law += law && tells_laws(row);
    counts.terms += terms && tells_terms(row);
    counts.both += law && terms && tells_laws(row) && tells_terms(row);
    count_neo_hookean(row, counts);
    if (!tells_laws(row) || std::abs(lead_of(row)) < clear_lead) return;
    ++counts.clear;
    counts.clear_and_right += lead_of(row) > 0;
}

Counts counts_of(const std::vector<Row>& rows) {
    Counts counts;
    for (const Row& row : rows) {
        count_row(row, counts);
        for (const std::string& law : laws())
            for (int terms = 0; terms <= most_terms; ++terms) {
                ++counts.models;
                counts.unusable += !is_usable(row, law, terms);
            }
    }
    return counts;
}

StudyPicture lead_picture(const std::vector<Row>& rows) {
    Plot plot("lead", 440, 300, {2.5, 30, true, "gamma: how fast the tissue stiffens"},
              {-2, 4, false, "decades of odds of the right law"});
    std::vector<double> at, lead, wrong_at, wrong;
    for (const Row& row : rows) {
        if (!tells_laws(row)) continue;
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

StudyTable counts_table(const Counts& counts) {
    StudyTable table{{"what", "of those that can be compared"}, {}};
    const auto add = [&](const std::string& what, int number, int of) {
        table.lines.push_back({what, fmt::format("{} of {}", number, of)});
    };
    add("right law first", counts.law, counts.of_law);
    add("right number of relaxation terms first", counts.terms, counts.of_terms);
    add("both", counts.both, counts.of_both);
    add("neo-Hookean rejected (20 to 1)", counts.rejected, counts.of_rejected);
    add("laws told apart (20 to 1), of these the right one first", counts.clear_and_right,
        counts.clear);
    add("models left out, whose search did not end well", counts.unusable, counts.models);
    return table;
}

/// A line for each true law: how often it came first.
StudyTable by_law_table(const std::vector<Row>& rows) {
    StudyTable table{{"true law", "tissues", "right law first", "right number of terms first"}, {}};
    for (const char* law : {exponential_law, polynomial_law}) {
        std::vector<Row> some;
        for (const Row& row : rows)
            if (row.text("true_law") == law) some.push_back(row);
        const Counts counts = counts_of(some);
        table.lines.push_back({law, fmt::format("{}", some.size()),
                               fmt::format("{} of {}", counts.law, counts.of_law),
                               fmt::format("{} of {}", counts.terms, counts.of_terms)});
    }
    return table;
}

StudyReport laws_report(const std::vector<Row>& rows) {
    const Counts counts = counts_of(rows);
    const StudyTable table = counts_table(counts), by_law = by_law_table(rows);
    StudyReport report;
    report.headline = fmt::format(
        "The right law is first in {} of {}, with the right number of relaxation terms in {} of {}",
        counts.law, counts.of_law, counts.both, counts.of_both);
    report.sentences = {
        std::string(SuckedScene::sentence()) +
            fmt::format(
                " Its tissue follows two laws that stiffen in turn, with one or two "
                "relaxation terms, drawn from the seed; heights have noise of {:g} um. "
                "Neo-Hookean and both laws are fitted with none to {} terms, and compared "
                "by their evidence; of two that are less than {:g} in ln evidence apart the "
                "one with fewer numbers comes first.",
                1000 * noise_mm, most_terms, bare_mention),
        "The instrument is known, and cells and time steps of the fit are those of the truth: "
        "films know less. Searches for two terms begin where that for one ended. A model "
        "whose search did not end well from any of its starts beats no other and is beaten by "
        "none."};
    report.sections = {
        {"Which law comes first", table.html() + by_law.html(), {lead_picture(rows)}}};
    report.facts = {{"cases", double(rows.size())},
                    {"law_compared", counts.of_law},
                    {"law_right", counts.law},
                    {"terms_compared", counts.of_terms},
                    {"terms_right", counts.terms},
                    {"both_compared", counts.of_both},
                    {"both_right", counts.both},
                    {"neo_hookean_compared", counts.of_rejected},
                    {"neo_hookean_rejected", counts.rejected},
                    {"told_apart", counts.clear},
                    {"told_apart_and_right", counts.clear_and_right},
                    {"models", counts.models},
                    {"models_unusable", counts.unusable}};
    report.text = table.plain() + by_law.plain();
    return report;
}

}  // namespace

Study make_aspiration_laws_study(const StudyOptions& options) {
    Study study{"aspiration-laws",
                "Which law sucked tissue follows, told by the evidence",
                {{"first seed", fmt::format("{}", options.first_seed)},
                 {"noise, mm", fmt::format("{}", noise_mm)},
                 {"laws", "in turn"}},
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
