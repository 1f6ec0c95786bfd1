// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/apps/study/beside.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/apps/study/statistics.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double assumed_ratio = 0.40;
const std::vector<std::string> colours{"#2f86c9", "#009e73", "#d55e00", "#8a63c9"};

/// One line per true ratio, one column per true stiffness: the mean error of the scenes.
StudyTable ratio_error_table(const std::vector<Row>& rows) {
    std::map<std::pair<double, double>, std::vector<double>> errors;
    for (const Row& row : rows)
        errors[{row.number("true_kpa"), row.number("true_poisson_ratio")}].push_back(
            row.number("error_percent"));
    BesideTable table("true Poisson's ratio");
    for (const auto& [key, values] : errors)
        table.add(key.second, fmt::format("{:g} kPa", key.first), signed_percent(mean_of(values)));
    for (const auto& [ratio, error] : published_poisson()) table.add(ratio, "published", error);
    return table.table();
}

StudyPicture error_over_ratio(const std::vector<Row>& rows) {
    std::set<double> moduli;
    double reach = 20;
    for (const Row& row : rows) {
        moduli.insert(row.number("true_kpa"));
        reach = std::max(reach, 1.1 * std::abs(row.number("error_percent")));
    }
    Plot plot("poisson", 440, 340, {0.28, 0.51, false, "true Poisson's ratio of the prostate"},
              {-reach, reach, false, "error of E, %"});
    plot.guide({0.28, 0.51}, {0, 0}, "");
    plot.vertical_rule(assumed_ratio, "assumed", "var(--soft)");
    std::vector<LegendEntry> legend;
    for (const double modulus : moduli) {
        std::vector<double> x, y;
        for (const Row& row : rows) {
            if (row.number("true_kpa") != modulus) continue;
            x.push_back(row.number("true_poisson_ratio"));
            y.push_back(row.number("error_percent"));
        }
        const std::string& colour = colours[legend.size() % colours.size()];
        plot.points(x, y, colour, false);
        legend.push_back({fmt::format("{:g} kPa", modulus), colour});
    }
    return {"poisson", plot.svg("Error over the true Poisson's ratio"), legend_html(legend),
            "Error of the recovered stiffness over the true Poisson's ratio; 0.40 was assumed."};
}

double worst_error(const std::vector<Row>& rows, double ratio) {
    double worst = 0;
    for (const Row& row : rows)
        if (std::abs(row.number("true_poisson_ratio") - ratio) < 1e-9)
            worst = std::max(worst, std::abs(row.number("error_percent")));
    return worst;
}

StudyReport poisson_report(const std::vector<Row>& rows) {
    StudyReport report;
    report.headline = fmt::format(
        "A prostate of Poisson's ratio 0.30 or 0.49 instead of 0.40: error up to {:.0f} and {:.0f} "
        "%",
        worst_error(rows, 0.30), worst_error(rows, 0.49));
    report.sentences = {
        "Recoveries assume a Poisson's ratio unless they are asked to search it too. Here the "
        "prostate truly has another ratio than the assumed 0.40."};
    report.sections = {{"Error by true ratio",
                        ratio_error_table(rows).html("beside") +
                            "<p class='caption'>Mean over the scenes. " + published_source() +
                            "</p>",
                        {error_over_ratio(rows)}}};
    for (const double ratio : {0.30, 0.35, 0.40, 0.45, 0.49})
        report.facts.emplace_back(fmt::format("ratio {:.2f}: worst_abs_error_percent", ratio),
                                  worst_error(rows, ratio));
    report.text = ratio_error_table(rows).plain();
    return report;
}

}  // namespace

Study make_poisson_study(const StudyOptions& options) {
    Study study{"poisson",
                "Wrongly assumed Poisson's ratio",
                pelvis_settings(options),
                pelvis_columns(),
                {},
                poisson_report};
    study.columns.insert(study.columns.begin(), "true_poisson_ratio");
    for (int scene = 0; scene < options.phantoms; ++scene)
        for (const double stiffness_kpa : {50, 100, 150, 200})
            for (const double ratio : {0.30, 0.35, 0.40, 0.45, 0.49}) {
                PelvisCase work;
                work.truth =
                    pelvis_options(options, options.first_seed + unsigned(scene), stiffness_kpa);
                work.truth.poisson_ratio = ratio;
                work.labels = {{"true_poisson_ratio", fmt::format("{:.2f}", ratio)}};
                work.assume = [](Settings& settings) {
                    for (OrganSettings& organ : settings.organs)
                        if (organ.role == Role::tissue) organ.poisson_ratio = assumed_ratio;
                };
                study.cases.push_back(study_case(work, options));
            }
    return study;
}

}  // namespace palpate
