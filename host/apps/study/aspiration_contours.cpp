// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/apps/aspirate/contours/contour_tracker.hpp"
#include "host/apps/aspirate/contours/published_outline.hpp"
#include "host/apps/study/aspiration_film.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/studies.hpp"
#include "host/apps/study/tables.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr Index num_films = 12, num_frames = 40;
constexpr unsigned first_film = 101;  // the method was tuned on films 1 to 4
constexpr double outlier_px = 3;      // a point is wrong beyond
constexpr double margin_rows = 6;     // points nearer to the line of visibility do not count
constexpr Index margin_columns = 4;

/// Errors of the points of films of one kind that are not flagged.
struct ContourErrors {
    double squares = 0, sum = 0;
    Index num_points = 0, num_flagged = 0, num_wrong = 0, num_held = 0, num_near = 0;

    void add(const AspirationFilm& film, Index frame, const Outline& found) {
        const std::vector<double> truth = film.outline(frame);
        for (Index x = margin_columns; x < film.width() - margin_columns; ++x) {
            if (truth[x] > film.visible_rows() - margin_rows) continue;
            ++num_points;
            const double error = found[x].row - truth[x];
            if (found[x].flag != PointFlag::ok) {
                ++num_flagged;
            } else if (std::abs(error) > outlier_px) {
                ++num_wrong;
            } else {
                ++num_near;
                squares += error * error;
                sum += error;
                if (std::abs(error) <= 1.96 * found[x].sd) ++num_held;
            }
        }
    }
    double rms() const { return std::sqrt(squares / std::max<Index>(1, num_near)); }
    double bias() const { return sum / std::max<Index>(1, num_near); }
    double part(Index count) const { return 100.0 * count / std::max<Index>(1, num_points); }

    void write(Row& row, const std::string& name) const {
        row.set(name + "_rms_px", rms(), 3);
        row.set(name + "_bias_px", bias(), 3);
        row.set(name + "_wrong_percent", part(num_wrong), 2);
        row.set(name + "_flagged_percent", part(num_flagged), 2);
        row.set(name + "_held_percent", 100.0 * num_held / std::max<Index>(1, num_near), 1);
    }
};

Row run_scene(const FilmScene& scene, const ProgressSink& progress) {
    ContourErrors ours, published;
    for (Index k = 0; k < num_films; ++k) {
        const AspirationFilm film(scene, first_film + unsigned(k), num_frames);
        const ContourSettings settings{film.width(), film.height(), film.visible_rows(), true};
        ContourTracker tracker(settings);
        PublishedOutline baseline(settings);
        for (Index frame = 0; frame < num_frames; ++frame) {
            report_progress(progress, "frames",
                            double(k * num_frames + frame) / (num_films * num_frames), scene.name);
            const std::vector<std::uint8_t> grey = film.frame(frame);
            const GreyFrame one{film.width(), film.height(), {grey.begin(), grey.end()}};
            ours.add(film, frame, tracker.add(one));
            published.add(film, frame, baseline.add(one));
        }
    }
    Row row;
    row.set("scene", scene.name);
    ours.write(row, "ours");
    published.write(row, "published");
    return row;
}

StudyTable contour_table(const std::vector<Row>& rows) {
    StudyTable table{{"frames", "rms, px", "bias, px", "beyond 3 px, not flagged", "flagged",
                      "within 1.96 sd", "rms, px", "bias, px", "beyond 3 px"},
                     {},
                     {{"ours", 5}, {"published method", 3}}};
    for (const Row& row : rows)
        table.lines.push_back(
            {row.text("scene"), row.text("ours_rms_px"), row.text("ours_bias_px"),
             row.text("ours_wrong_percent") + " %", row.text("ours_flagged_percent") + " %",
             row.text("ours_held_percent") + " %", row.text("published_rms_px"),
             row.text("published_bias_px"), row.text("published_wrong_percent") + " %"});
    return table;
}

StudyPicture wrong_picture(const std::vector<Row>& rows) {
    Plot plot("wrong", 440, 300, {0.5, 6.5, false, "row of the table"},
              {0, 60, false, "points beyond 3 px without a flag, %"});
    std::vector<double> at, ours, published;
    for (const Row& row : rows) {
        at.push_back(double(at.size()) + 1);
        ours.push_back(row.number("ours_wrong_percent"));
        published.push_back(row.number("published_wrong_percent"));
    }
    plot.points(at, published, published_colour, true);
    plot.points(at, ours, our_colour, false);
    return {"wrong", plot.svg("Points beyond 3 pixels without a flag"),
            legend_html({{"ours", our_colour}, {"published method", published_colour, true}}),
            "Share of points that are wrong by more than 3 pixels and do not say so."};
}

StudyReport contours_report(const std::vector<Row>& rows) {
    double worst = 0, worst_flagged = 0, worst_published = 0;
    for (const Row& row : rows) {
        worst = std::max(worst, row.number("ours_wrong_percent"));
        worst_flagged = std::max(worst_flagged, row.number("ours_flagged_percent"));
        worst_published = std::max(worst_published, row.number("published_wrong_percent"));
    }
    StudyReport report;
    report.headline = fmt::format(
        "At most {:.1f} % of points are wrong by more than 3 pixels without a flag; published: "
        "{:.0f} %",
        worst, worst_published);
    report.sentences = {fmt::format(
        "{} films of {} frames of 180 x 180 pixels for each row: a cap of 1 mm over a hole of 10 "
        "mm "
        "that rises by 1.65 mm and comes back, with an outline that is a formula. At most {:.1f} % "
        "of "
        "points are flagged. Errors are those of points without a flag and within 3 pixels.",
        num_films, num_frames, worst_flagged)};
    report.sections = {
        {"Errors of outlines", contour_table(rows).html("beside"), {wrong_picture(rows)}}};
    report.facts = {{"worst_wrong_percent", worst},
                    {"worst_flagged_percent", worst_flagged},
                    {"published_worst_wrong_percent", worst_published}};
    report.text = contour_table(rows).plain();
    return report;
}

}  // namespace

Study make_aspiration_contours_study(const StudyOptions&) {
    Study study{
        "aspiration-contours",
        "Outlines of sucked tissue from frames with a known outline",
        {{"films", fmt::format("{}", num_films)}, {"frames", fmt::format("{}", num_frames)}},
        {"scene"},
        {},
        contours_report};
    for (const char* method : {"ours", "published"})
        for (const char* value :
             {"rms_px", "bias_px", "wrong_percent", "flagged_percent", "held_percent"})
            study.columns.push_back(fmt::format("{}_{}", method, value));
    for (std::size_t k = 0; k < film_suite().size(); ++k)
        study.cases.push_back({fmt::format("scene-{}", k + 1), film_suite()[k].name,
                               [scene = film_suite()[k]](const ProgressSink& progress) {
                                   return run_scene(scene, progress);
                               }});
    return study;
}

}  // namespace palpate
