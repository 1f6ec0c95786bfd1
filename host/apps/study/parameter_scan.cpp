// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "host/apps/study/beside.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/page/numbers.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double start_ratios[] = {2, 10, 40};  // prior median over the background's stiffness

/// "E:F E:F ..." of the unknown modulus, so that one row holds a curve.
std::string profile_text(const RecoveryResult& result) {
    std::string text;
    for (const ProfileResult& profile : result.profiles)
        for (std::size_t k = 0; k < profile.objective.size(); ++k)
            text += fmt::format("{}{:.2f}:{:.3f}", text.empty() ? "" : " ",
                                profile.stiffness_kpa[k], profile.objective[k]);
    return text;
}

struct Curve {
    std::vector<double> stiffness_kpa, objective;
};

Curve curve_of(const std::string& text) {
    Curve curve;
    std::istringstream in(text);
    double stiffness_kpa = 0, objective = 0;
    char colon = 0;
    while (in >> stiffness_kpa >> colon >> objective) {
        curve.stiffness_kpa.push_back(stiffness_kpa);
        curve.objective.push_back(objective);
    }
    return curve;
}

StudyPicture profile_picture(const Row& row) {
    const Curve curve = curve_of(row.text("profile"));
    const double truth = row.number("true_kpa");
    double low = truth, high = truth, top = 2.5;
    for (std::size_t k = 0; k < curve.objective.size(); ++k) {
        low = std::min(low, curve.stiffness_kpa[k]);
        high = std::max(high, curve.stiffness_kpa[k]);
        top = std::max(top, curve.objective[k]);
    }
    Plot plot("profile-" + row.text("case"), 440, 300,
              {low / 1.1, high * 1.1, true, "E of the prostate, kPa"},
              {0, std::min(top, 8.0), false, "objective above its minimum"});
    plot.band(row.number("low_kpa"), row.number("high_kpa"), our_colour);
    plot.vertical_rule(truth, "truth", miss_colour);
    plot.horizontal_rule(1.92, "1.92: 95 %");
    plot.curve(curve.stiffness_kpa, curve.objective, our_colour, true);
    return {"profile-" + row.text("case"), plot.svg("Profile of the objective"), "",
            fmt::format("Seed {}, true {} kPa: the objective over E, wall motion integrated out. "
                        "Shaded: the interval, the model's own error included.",
                        row.text("seed"), significant(truth))};
}

StudyTable start_table(const std::vector<Row>& rows) {
    BesideTable table("true E, kPa");
    for (const Row& row : rows)
        table.add(row.number("true_kpa"),
                  fmt::format("seed {}, prior median {} kPa", row.text("seed"),
                              significant(row.number("prior_median_kpa"))),
                  significant(row.number("found_kpa")));
    return table.table();
}

/// Largest ratio of the stiffnesses that one phantom gave from different priors.
double largest_spread(const std::vector<Row>& rows) {
    std::map<std::pair<std::string, double>, std::pair<double, double>> range;
    for (const Row& row : rows) {
        const double found = row.number("found_kpa");
        const auto [at, is_new] =
            range.try_emplace({row.text("seed"), row.number("true_kpa")}, found, found);
        at->second = {std::min(at->second.first, found), std::max(at->second.second, found)};
    }
    double spread = 1;
    for (const auto& [key, ends] : range) spread = std::max(spread, ends.second / ends.first);
    return spread;
}

StudyReport parameter_scan_report(const std::vector<Row>& rows) {
    const double spread = largest_spread(rows);
    StudyReport report;
    report.headline = fmt::format(
        "Priors that differ twentyfold change the result by at most {:.0f} %", 100 * (spread - 1));
    report.sentences = {
        "The objective as a function of the prostate's stiffness, and the stiffness that is found "
        "when the search is told beforehand to expect 20, 100 or 400 kPa. The search itself scans "
        "all stiffnesses, so it has no other start."};
    StudySection profiles{"The objective over the stiffness", "", {}};
    for (const Row& row : rows)
        if (row.number("prior_median_kpa") == 100)
            profiles.pictures.push_back(profile_picture(row));
    report.sections = {profiles,
                       {"Recovered stiffness, kPa", start_table(rows).html("beside"), {}}};
    report.facts = {{"largest_ratio_between_priors", spread}};
    report.text = start_table(rows).plain();
    return report;
}

StudyCase scan_case(const PelvisCase& work, const StudyOptions& options) {
    return {id_of(work), title_of(work), [work, options](const ProgressSink& progress) {
                const PelvisOutcome outcome = run_pelvis_case(work, options, progress);
                Row row = pelvis_row(work, outcome);
                row.set("profile", profile_text(outcome.result));
                return row;
            }};
}

}  // namespace

Study make_parameter_scan(const StudyOptions& options) {
    Study study{"parameter-scan",
                "The objective and what the search expects",
                pelvis_settings(options),
                pelvis_columns(),
                {},
                parameter_scan_report};
    study.columns.insert(study.columns.begin(), "prior_median_kpa");
    study.columns.push_back("profile");
    for (int scene = 0; scene < options.phantoms; ++scene)
        for (const double stiffness_kpa : {50, 100, 200})
            for (const double ratio : start_ratios) {
                PelvisCase work;
                work.truth =
                    pelvis_options(options, options.first_seed + unsigned(scene), stiffness_kpa);
                const double median_kpa = ratio * work.truth.background_stiffness_kpa;
                work.labels = {{"prior_median_kpa", fmt::format("{:g}", median_kpa)}};
                work.assume = [ratio](Settings& settings) {
                    settings.prior.stiffness_median_ratio = ratio;
                };
                study.cases.push_back(scan_case(work, options));
            }
    return study;
}

}  // namespace palpate
