// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "host/apps/study/demons.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/apps/study/statistics.hpp"
#include "host/apps/study/tables.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

std::vector<double> column_of(const std::vector<Row>& rows, const std::string& name) {
    std::vector<double> values;
    for (const Row& row : rows) values.push_back(row.number(name));
    return values;
}

double largest(const std::vector<double>& values) {
    return *std::max_element(values.begin(), values.end());
}

/// How far the landmarks truly moved.
std::vector<double> motions_mm(const PelvisPhantom& phantom) {
    std::vector<double> motions;
    for (const Vec3& u : phantom.landmark_displacements) motions.push_back(u.norm());
    return motions;
}

Row compare(const PelvisCase& work, const StudyOptions& options, const ProgressSink& progress) {
    const PelvisOutcome outcome = run_pelvis_case(work, options, progress);
    Row row = pelvis_row(work, outcome);
    report_progress(progress, "demons", 0);
    const auto begin = std::chrono::steady_clock::now();
    const auto field = demons_displacement(outcome.phantom.reference, outcome.phantom.target);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    const auto errors = landmark_errors_mm(outcome.phantom, field);
    row.set("moved_mean_mm", mean_of(motions_mm(outcome.phantom)), 3);
    row.set("demons_mean_mm", mean_of(errors), 3);
    row.set("demons_max_mm", largest(errors), 3);
    row.set("demons_seconds", seconds.count(), 1);
    return row;
}

StudyPicture landmark_picture(const std::vector<double>& ours, const std::vector<double>& demons) {
    std::vector<double> their_ours, their_demons;
    for (const auto& [joint_mm, demons_mm] : published_landmarks()) {
        their_ours.push_back(joint_mm);
        their_demons.push_back(demons_mm);
    }
    const double high = 1.1 * std::max({largest(ours), largest(demons), largest(their_ours),
                                        largest(their_demons)});
    Plot plot("landmarks", 440, 380, {0, high, false, "demons, mean landmark error, mm"},
              {0, high, false, "with mechanics, mean landmark error, mm"});
    plot.guide({0, high}, {0, high}, "");
    plot.points(their_demons, their_ours, published_colour, true);
    plot.points(demons, ours, our_colour, false);
    return {"landmarks", plot.svg("Landmark error with mechanics over that of demons"),
            legend_html({{"palpate, phantoms", our_colour},
                         {"published, patients", published_colour, true}}),
            "Below the dashed line mechanics help."};
}

StudyTable method_table(const std::vector<Row>& rows) {
    StudyTable table{{"", "mean, mm", "largest mean, mm", "largest point, mm"}, {}};
    const auto add = [&](const std::string& name, const std::vector<double>& mean,
                         const std::vector<double>& worst) {
        table.lines.push_back({name, fmt::format("{:.2f}", mean_of(mean)),
                               fmt::format("{:.2f}", largest(mean)),
                               worst.empty() ? "–" : fmt::format("{:.2f}", largest(worst))});
    };
    add("no registration", column_of(rows, "moved_mean_mm"), {});
    add("demons", column_of(rows, "demons_mean_mm"), column_of(rows, "demons_max_mm"));
    add("palpate", column_of(rows, "landmark_mean_mm"), column_of(rows, "landmark_max_mm"));
    return table;
}

std::string test_sentence(const std::vector<double>& ours, const std::vector<double>& demons) {
    if (ours.size() < 2) return "One phantom allows no test.";
    const PairedTest test = paired_t_test(demons, ours);
    return fmt::format(
        "Demons minus palpate: {:+.2f} mm (95 % {:+.2f} to {:+.2f} mm), paired t-test over {} "
        "phantoms: t = {:.1f}, p = {}.",
        test.mean_difference, test.interval[0], test.interval[1], ours.size(), test.t,
        test.p < 1e-4 ? std::string("below 0.0001") : fmt::format("{:.4f}", test.p));
}

std::string published_table() {
    StudyTable table{{"published, patient", "joint recovery, mm", "demons, mm"}, {}};
    for (const auto& [joint_mm, demons_mm] : published_landmarks())
        table.lines.push_back({fmt::format("{}", table.lines.size() + 1),
                               fmt::format("{:.1f}", joint_mm), fmt::format("{:.1f}", demons_mm)});
    return table.html() + "<p class='caption'>" + published_source() + "</p>";
}

StudyReport registration_report(const std::vector<Row>& rows) {
    const auto ours = column_of(rows, "landmark_mean_mm");
    const auto demons = column_of(rows, "demons_mean_mm");
    StudyReport report;
    report.headline = fmt::format(
        "Points inside the prostate: {:.2f} mm off with mechanics, {:.2f} mm with demons",
        mean_of(ours), mean_of(demons));
    report.sentences = {
        "Inside an organ a label volume shows nothing: where its points went must come from the "
        "model. Both methods see the same two label volumes; 200 points inside each prostate, "
        "whose true motion is known, judge them.",
        test_sentence(ours, demons),
        "The phantoms deform as the model assumes, so this is the best case for mechanics."};
    report.sections = {{"Landmark error",
                        method_table(rows).html("beside") + published_table(),
                        {landmark_picture(ours, demons)}}};
    report.facts = {{"palpate_mean_mm", mean_of(ours)}, {"demons_mean_mm", mean_of(demons)}};
    if (rows.size() > 1) report.facts.emplace_back("p", paired_t_test(demons, ours).p);
    report.text = method_table(rows).plain() + test_sentence(ours, demons) + "\n";
    return report;
}

}  // namespace

Study make_registration_study(const StudyOptions& options) {
    Study study{"registration",
                "Landmarks with mechanics and without",
                pelvis_settings(options),
                pelvis_columns(),
                {},
                registration_report};
    for (const char* column :
         {"moved_mean_mm", "demons_mean_mm", "demons_max_mm", "demons_seconds"})
        study.columns.push_back(column);
    for (int k = 0; k < options.phantoms; ++k) {
        const unsigned seed = options.first_seed + unsigned(k);
        PelvisCase work;
        work.truth = pelvis_options(options, seed, drawn_stiffness_kpa(seed));
        study.cases.push_back({fmt::format("seed-{}", seed), title_of(work),
                               [work, options](const ProgressSink& progress) {
                                   return compare(work, options, progress);
                               }});
    }
    return study;
}

}  // namespace palpate
