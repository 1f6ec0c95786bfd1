// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "host/apps/study/beside.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/page/numbers.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double healthy_kpa = 50, tumour_kpa = 100;

/// Mean of the stiffness over the volume (Voigt's upper bound of the whole) and of its inverse
/// (Reuss's lower bound), kPa.
double upper_bound_kpa(double fraction) {
    return (1 - fraction) * healthy_kpa + fraction * tumour_kpa;
}
double lower_bound_kpa(double fraction) {
    return 1 / ((1 - fraction) / healthy_kpa + fraction / tumour_kpa);
}

StudyTable tumour_table(const std::vector<Row>& rows) {
    BesideTable table("tumour, % of the prostate");
    for (const Row& row : rows) {
        const double fraction = row.number("tumour_fraction");
        table.add(
            100 * fraction, "palpate, seed " + row.text("seed"),
            fmt::format("{} ({} to {})", significant(row.number("found_kpa")),
                        significant(row.number("low_kpa")), significant(row.number("high_kpa"))));
    }
    for (const auto& value : published_tumour()) {
        table.add(100 * value.fraction, "published, scene 1", significant(value.scene_1_kpa));
        table.add(100 * value.fraction, "published, scene 2", significant(value.scene_2_kpa));
    }
    for (const Row& row : rows) {
        const double fraction = row.number("tumour_fraction");
        table.add(100 * fraction, "bounds of a mixture",
                  fmt::format("{} to {}", significant(lower_bound_kpa(fraction)),
                              significant(upper_bound_kpa(fraction))));
    }
    return table.table();
}

StudyPicture found_over_fraction(const std::vector<Row>& rows) {
    std::vector<double> x, y, low, high, their_x, their_y, f, upper, lower;
    double largest = tumour_kpa;
    for (const Row& row : rows) {
        x.push_back(100 * row.number("tumour_fraction"));
        y.push_back(row.number("found_kpa"));
        low.push_back(row.number("low_kpa"));
        high.push_back(row.number("high_kpa"));
        largest = std::max(largest, high.back());
    }
    for (const auto& value : published_tumour())
        for (const double kpa : {value.scene_1_kpa, value.scene_2_kpa}) {
            their_x.push_back(100 * value.fraction);
            their_y.push_back(kpa);
        }
    for (int percent = 0; percent <= 85; percent += 5) {
        f.push_back(percent);
        upper.push_back(upper_bound_kpa(percent / 100.0));
        lower.push_back(lower_bound_kpa(percent / 100.0));
    }
    Plot plot("tumour", 440, 340, {-5, 85, false, "tumour, % of the prostate's volume"},
              {30, 1.05 * largest, false, "recovered E of the whole, kPa"});
    plot.guide(f, upper, "");
    plot.guide(f, lower, "");
    plot.bars(x, low, high, our_colour);
    plot.points(their_x, their_y, published_colour, true);
    plot.points(x, y, our_colour, false);
    return {"tumour", plot.svg("Recovered stiffness over the size of a tumour"),
            legend_html({{"palpate with 95 % interval", our_colour},
                         {"published", published_colour, true}}),
            "One stiffness for the whole prostate. Dashed: upper and lower bound of a mixture of "
            "50 and 100 kPa."};
}

/// Mean recovered stiffness at one fraction over that without tumour.
double ratio_at(const std::vector<Row>& rows, double fraction) {
    double sum = 0, healthy = 0;
    int count = 0, num_healthy = 0;
    for (const Row& row : rows) {
        if (row.number("tumour_fraction") == fraction) sum += row.number("found_kpa"), ++count;
        if (row.number("tumour_fraction") == 0) healthy += row.number("found_kpa"), ++num_healthy;
    }
    return count > 0 && num_healthy > 0 ? sum / count / (healthy / num_healthy) : 0;
}

StudyReport tumour_report(const std::vector<Row>& rows) {
    StudyReport report;
    report.headline = fmt::format(
        "A tumour twice as stiff in half of the prostate raises its stiffness by {:.0f} %",
        100 * (ratio_at(rows, 0.5) - 1));
    report.sentences = {
        "A tumour of 100 kPa grows as a ball inside a prostate of 50 kPa. It has no label: the "
        "recovery knows one prostate and finds one stiffness for the whole."};
    report.sections = {{"Recovered stiffness of the whole, kPa",
                        tumour_table(rows).html("beside") +
                            "<p class='caption'>In brackets: 95 % interval. " + published_source() +
                            "</p>",
                        {found_over_fraction(rows)}}};
    for (const double fraction : {0.10, 0.25, 0.50, 0.75})
        report.facts.emplace_back(fmt::format("fraction {:.2f}: ratio_to_healthy", fraction),
                                  ratio_at(rows, fraction));
    report.text = tumour_table(rows).plain();
    return report;
}

}  // namespace

Study make_tumour_study(const StudyOptions& options) {
    Study study{"tumour",
                "A stiff tumour that has no label",
                pelvis_settings(options),
                pelvis_columns(),
                {},
                tumour_report};
    for (const char* column : {"holds_truth", "error_percent", "expected_kpa", "true_kpa"})
        study.columns.erase(std::find(study.columns.begin(), study.columns.end(), column));
    study.columns.insert(study.columns.begin(), "tumour_fraction");
    for (int scene = 0; scene < options.phantoms; ++scene)
        for (const double fraction : {0.0, 0.10, 0.25, 0.50, 0.75}) {
            PelvisCase work;
            work.truth = pelvis_options(options, options.first_seed + unsigned(scene), healthy_kpa);
            work.truth.tumour_fraction = fraction;
            work.truth.tumour_stiffness_kpa = tumour_kpa;
            work.labels = {{"tumour_fraction", fmt::format("{:.2f}", fraction)}};
            study.cases.push_back(study_case(work, options));
        }
    return study;
}

}  // namespace palpate
