// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/fit_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "host/apps/aspirate/tissue_tree.hpp"
#include "host/estimate/model_choice.hpp"
#include "host/page/legend.hpp"
#include "host/page/markup.hpp"
#include "host/page/page.hpp"
#include "host/page/plain_text.hpp"
#include "host/page/plot.hpp"
#include "host/page/tree_html.hpp"
#include "host/page/tree_table.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

constexpr double width = 560, height = 300, near_axis_mm = 0.3;

std::string figure_html(const std::string& picture, const std::string& caption) {
    return "<figure>" + picture + "<figcaption>" + escape_html(caption) + "</figcaption></figure>";
}

PlotAxis axis_of(std::vector<double> values, const std::string& label) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double room = *high > *low ? 0.05 * (*high - *low) : 1;
    return {*low - room, *high + room, false, label};
}

/// Times and heights of the rows nearest to the axis, of what was measured and what is predicted.
struct ApexRows {
    std::vector<double> time_s, measured, predicted, suction_kpa;
};

ApexRows apex_rows(const AspirationFit& fit) {
    const DataBlock& block = fit.best().found->fit.prediction->blocks.front();
    ApexRows rows;
    for (Index row = 0; row < block.num_row(); ++row) {
        if (std::abs(block.position_mm(row, 0)) > near_axis_mm) continue;
        rows.time_s.push_back(block.time_s[row]);
        rows.measured.push_back(block.measured[row]);
        rows.predicted.push_back(block.predicted[row]);
        rows.suction_kpa.push_back(
            fit.suction.at(block.time_s[row] + fit.input.begin_s - fit.settings.delay_s.value));
    }
    return rows;
}

std::string history_picture(const AspirationFit& fit) {
    const ApexRows rows = apex_rows(fit);
    if (rows.time_s.empty()) return "";
    std::vector<double> heights = rows.measured;
    heights.insert(heights.end(), rows.predicted.begin(), rows.predicted.end());
    Plot over_time("apex", width, height, axis_of(rows.time_s, "time from the begin of suction, s"),
                   axis_of(heights, "height on the axis, mm"));
    over_time.points(rows.time_s, rows.measured, list_colour(0), true);
    over_time.curve(rows.time_s, rows.predicted, list_colour(1), false);
    Plot loop("loop", width, height, axis_of(rows.suction_kpa, "suction, kPa"),
              axis_of(heights, "height on the axis, mm"));
    loop.points(rows.suction_kpa, rows.measured, list_colour(0), true);
    loop.curve(rows.suction_kpa, rows.predicted, list_colour(1), false);
    const std::string legend =
        legend_html({{"measured", list_colour(0), true}, {"model", list_colour(1)}});
    std::vector<double> seconds;
    for (const double time_s : fit.suction.time_s) seconds.push_back(time_s - fit.input.begin_s);
    Plot suction("suction", width, 200, axis_of(seconds, "time from the begin of suction, s"),
                 axis_of(fit.suction.kpa, "suction, kPa"));
    suction.curve(seconds, fit.suction.kpa, "var(--accent)", false);
    return "<div class='figures'>" +
           figure_html(legend + over_time.svg("Height on the axis over time"),
                       "How high the tissue stands on the axis.") +
           figure_html(legend + loop.svg("Height on the axis over suction"),
                       "The same over the suction: a loop, because the tissue relaxes.") +
           figure_html(suction.svg("Suction over time"), "The suction that was read.") + "</div>";
}

/// Blue below, red above, white for none.
std::string colour_of(double part) {
    const double size = std::min(1.0, std::abs(part));
    const int pale = int(std::lround(255 - 185 * size));
    return part < 0 ? fmt::format("rgb({0},{0},255)", pale) : fmt::format("rgb(255,{0},{0})", pale);
}

/// What the colours mean, from -most to most, right above the map.
std::string colour_bar(double most) {
    constexpr int num_cell = 21;
    constexpr double bar_width = 210, cell = bar_width / num_cell;
    const double left = width - 10 - bar_width;
    std::string bar;
    for (int k = 0; k < num_cell; ++k)
        bar += fmt::format("<rect x='{:.1f}' y='18' width='{:.1f}' height='9' fill='{}'/>",
                           left + k * cell, cell + 0.3, colour_of(2.0 * k / (num_cell - 1) - 1));
    const auto label = [&](double x, const char* anchor, const std::string& words) {
        bar += fmt::format("<text x='{:.1f}' y='12' text-anchor='{}' class='label'>{}</text>", x,
                           anchor, words);
    };
    label(left, "start", fmt::format("-{:.3f}", most));
    label(left + bar_width / 2, "middle", "0");
    label(left + bar_width, "end", fmt::format("+{:.3f} mm", most));
    label(50, "start", "measured less model");
    return bar;
}

std::string residual_picture(const AspirationFit& fit) {
    const DataBlock& block = fit.best().found->fit.prediction->blocks.front();
    const Eigen::VectorXd residual = block.measured - block.predicted;
    const double most = std::max(1e-6, residual.cwiseAbs().maxCoeff());
    std::map<double, std::size_t> place;
    for (Index row = 0; row < block.num_row(); ++row) place.emplace(block.time_s[row], 0);
    std::size_t at = 0;
    for (auto& [time_s, column] : place) column = at++;
    const double left = 50, wide = (width - left - 10) / double(place.size());
    const double radius = block.position_mm.col(0).cwiseAbs().maxCoeff() + 0.25;
    constexpr double top = 38;
    const auto y_of = [&](double r_mm) { return top + 220 * (radius - r_mm) / (2 * radius); };
    std::string cells;
    for (Index row = 0; row < block.num_row(); ++row)
        cells += fmt::format(
            "<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='{}'><title>{:.2f} s, "
            "{:.1f} mm: {:+.4f} mm</title></rect>",
            left + wide * double(place[block.time_s[row]]), y_of(block.position_mm(row, 0) + 0.25),
            wide + 0.3, 220 * 0.5 / (2 * radius) + 0.3, colour_of(residual[row] / most),
            block.time_s[row], block.position_mm(row, 0), residual[row]);
    std::string labels;
    for (const double r_mm : tick_values({-radius, radius, false, ""}))
        labels += fmt::format(
            "<text x='{:.0f}' y='{:.1f}' text-anchor='end' class='label'>{:g}"
            "</text>",
            left - 6, y_of(r_mm) + 4, r_mm);
    for (const auto& [time_s, column] : place)
        if (column % std::max<std::size_t>(1, place.size() / 6) == 0)
            labels += fmt::format(
                "<text x='{:.1f}' y='276' text-anchor='middle' class='label'>"
                "{:.1f}</text>",
                left + wide * (double(column) + 0.5), time_s);
    labels += fmt::format(
        "<text x='{:.0f}' y='294' text-anchor='middle' class='label'>time from the begin of "
        "suction, s (frames that are fitted, not evenly spaced)</text><text x='12' y='148' "
        "transform='rotate(-90 12 148)' text-anchor='middle' class='label'>r, mm"
        "</text>",
        0.5 * (left + width));
    return figure_html(
        fmt::format("<svg class='map' viewBox='0 0 {:.0f} 300' role='img' aria-label='Residuals "
                    "over time and place'>{}{}{}</svg>",
                    width, colour_bar(most), cells, labels),
        "Blue: the tissue stands lower than the model says; red: higher; nothing is drawn where "
        "nothing was seen. What is patterned here is what the model does not explain.");
}

const char* search_words(const TriedModel& one) {
    switch (one.progress) {
        case ModelProgress::finished:
            return "to its end";
        case ModelProgress::compared:
            return one.found && !one.found->misfit.empty()
                       ? "on coarse cells; it is no model of this film"
                       : "on coarse cells; another model comes first";
        case ModelProgress::far_behind:
            return "given up near the optimum: far behind";
        case ModelProgress::not_fitted:
            return "none: this law is far behind";
    }
    return "";
}

ResultTree models_tree(const AspirationFit& fit) {
    ResultTree list{.name = "models",
                    .title = fit.models.size() > 1 ? "Laws that were tried" : "",
                    .shape = ResultTree::Shape::list};
    const auto is_known = [](const TriedModel& one) {
        return one.found && !one.found->identified.blocks.empty();
    };
    double total = 0, highest = fit.best().found->identified.log_evidence;
    for (const TriedModel& one : fit.models)
        if (is_known(one)) highest = std::max(highest, one.found->identified.log_evidence);
    for (const TriedModel& one : fit.models)
        if (is_known(one)) total += std::exp(one.found->identified.log_evidence - highest);
    for (const TriedModel& one : fit.models) {
        ResultTree part{.name = one.name};
        part.add(Figure{.name = "name", .value = one.name, .title = "Model"});
        if (is_known(one)) {
            const double evidence = one.found->identified.log_evidence;
            part.add(Figure{
                .name = "log_evidence", .value = evidence, .title = "ln evidence", .decimals = 1});
            part.add(Figure{.name = "weight",
                            .value = std::exp(evidence - highest) / total,
                            .title = "Weight",
                            .decimals = 3});
            part.add(Figure{.name = "rms_mm",
                            .value = one.found->identified.blocks.front().rms,
                            .unit = "mm",
                            .title = "Left unexplained (rms)",
                            .decimals = 4});
        }
        part.add(Figure{.name = "search", .value = search_words(one), .title = "Search"});
        if (one.found) part.add("misfit", one.found->misfit);
        if (one.progress == ModelProgress::finished) {
            part.add(
                Figure{.name = "converged", .value = one.found->converged(), .title = "Converged"});
            part.add("distrust", one.found->distrust());
        }
        list.add(std::move(part));
    }
    return list;
}

}  // namespace

const TriedModel& AspirationFit::best() const {
    const auto is_trusted = [](const TriedModel& one) {
        return one.progress == ModelProgress::finished && one.found->distrust().empty();
    };
    const bool is_any_trusted = std::any_of(models.begin(), models.end(), is_trusted);
    std::vector<ModelCandidate> candidates;
    std::vector<const TriedModel*> tried;
    for (const TriedModel& one : models) {
        if (one.progress != ModelProgress::finished || (is_any_trusted && !is_trusted(one)))
            continue;
        candidates.push_back({one.found->identified.log_evidence, one.num_parameter()});
        tried.push_back(&one);
    }
    return *tried[preferred_model(candidates)];
}

std::vector<std::string> AspirationFit::warnings() const {
    std::vector<std::string> all = input.warnings;
    const std::vector<std::string>& more = best().warnings;
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

ResultTree fit_tree(const AspirationFit& fit) {
    ResultTree tree = identified_tree(*fit.best().found);
    tree.name = "aspiration";
    tree.children.insert(tree.children.begin(), tissue_tree(*fit.best().found));
    ResultTree seen{.name = "film", .title = "What was looked at"};
    seen.add(Figure{.name = "model", .value = fit.best().name, .title = "Model"});
    seen.add(
        Figure{.name = "frames", .value = std::int64_t(fit.input.num_frames), .title = "Frames"});
    seen.add(Figure{.name = "used_frames",
                    .value = std::int64_t(fit.input.num_used_frames),
                    .title = "Frames that are fitted"});
    seen.add(Figure{.name = "flagged_percent",
                    .value = fit.input.flagged_percent,
                    .unit = "%",
                    .title = "Points that are flagged",
                    .decimals = 1});
    seen.add(Figure{.name = "asymmetry_mm",
                    .value = fit.input.asymmetry_mm,
                    .unit = "mm",
                    .title = "Asymmetry of what is fitted",
                    .decimals = 3});
    seen.add(Figure{.name = "axis_mm",
                    .value = fit.input.axis_mm,
                    .unit = "mm",
                    .title = fit.input.axis_mm != 0 ? "Axis, in r of the profiles" : "",
                    .decimals = 2});
    seen.add(Figure{.name = "travel_mm",
                    .value = *std::max_element(fit.input.apex.travel_mm.begin(),
                                               fit.input.apex.travel_mm.end()),
                    .unit = "mm",
                    .title = "Travel on the axis",
                    .decimals = 2});
    seen.add(Figure{.name = "peak_suction_kpa",
                    .value = fit.suction.peak_kpa(),
                    .unit = "kPa",
                    .title = "Largest suction"});
    seen.add(Figure{.value = fit.suction.peak_kpa() / kpa_per_mbar,
                    .unit = "mbar",
                    .title = "Largest suction, in mbar"});
    seen.add("warnings", fit.warnings());
    seen.add("settings", fit.settings.text);
    tree.add(std::move(seen));
    tree.add(models_tree(fit));
    return tree;
}

std::string fit_text(const AspirationFit& fit) {
    std::string text = harmless(fit.best().name) + "\n" + identified_text(*fit.best().found);
    if (fit.models.size() > 1)
        text +=
            '\n' +
            table_of(models_tree(fit), {"name", "log_evidence", "weight", "search"}, "-").text() +
            '\n';
    for (const std::string& warning : fit.warnings())
        text += "Warning: " + harmless(warning) + ".\n";
    return text;
}

std::string fit_page(const AspirationFit& fit, const ResultTree& tree, const FilmOutlines* film) {
    std::string notices;
    const std::string distrust = fit.best().found->distrust();
    if (!distrust.empty()) notices += "<p class='notice bad'>" + escape_html(distrust) + "</p>";
    for (const std::string& warning : fit.warnings())
        notices += "<p class='notice'>" + escape_html(warning) + ".</p>";
    std::string profiles;
    for (const Picture& picture : identified_pictures(*fit.best().found))
        profiles += figure_html(picture.html, picture.caption);
    // How the highest point travels is what the cycle shows.
    const std::string frames =
        film ? film_sections(film->strip, {}, {}, film_lines(*film, fit.settings.instrument)) : "";
    return page_html(
        {.kind = film ? "palpate aspirate run" : "palpate aspirate fit",
         .version = version_text(),
         .headline = distrust.empty() ? escape_html(tissue_sentence(*fit.best().found))
                                      : "No values to trust: see below",
         .lead = "<p class='summary'>Tissue that was sucked into a tube: " +
                 escape_html(fit.best().name) + ".</p>",
         .notices = notices,
         .main = tree_sections_html(
             tree, section_html("history", "Over the cycle", history_picture(fit)) +
                       section_html(
                           "profiles", "Profiles",
                           "<div class='figures'>" + profiles + residual_picture(fit) + "</div>") +
                       frames),
         .footer =
             "All figures: <code>result.json</code>; the model, with the values before they were "
             "corrected for cells and time steps: <code>identified.toml</code>, which "
             "<code>palpate simulate</code> runs.",
         .style = std::string(".map{width:100%}.map .label{font-size:11px;fill:currentColor}") +
                  (film ? film_style : "")});
}

}  // namespace palpate
