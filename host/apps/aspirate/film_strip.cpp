// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/film_strip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/page/legend.hpp"
#include "host/page/packing.hpp"
#include "host/page/page.hpp"
#include "host/page/plot.hpp"
#include "host/page/png.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_shown = 12;
constexpr const char* sure_colour = "#22c55e";
constexpr const char* guess_colour = "#ff8c1a";
constexpr const char* line_colour = "#60a5fa";

/// Runs of points with (or without) a flag as lines, hidden ones left out.
std::string lines_of(const Outline& outline, bool is_sure, const char* colour, double stretch) {
    std::string lines, points;
    const auto end_line = [&] {
        if (!points.empty())
            lines += fmt::format(
                "<polyline points='{}' fill='none' stroke='{}' stroke-width='1.2' "
                "stroke-linecap='round' stroke-linejoin='round'/>",
                points, colour);
        points.clear();
    };
    for (std::size_t x = 0; x < outline.size(); ++x) {
        const OutlinePoint& point = outline[x];
        const bool is_drawn =
            point.flag != PointFlag::hidden && (point.flag == PointFlag::ok) == is_sure;
        if (!is_drawn) {
            end_line();
            continue;
        }
        if (points.empty()) points = fmt::format("{},{:.2f} ", x, (point.row + 0.5) * stretch);
        points += fmt::format("{:.1f},{:.2f} ", double(x) + 0.5, (point.row + 0.5) * stretch);
    }
    end_line();
    return lines;
}

std::string instrument_lines(const FilmLines& lines, Index width, double drawn) {
    const auto level = [&](double row, const char* dashes) {
        const double y = (row + 0.5) * lines.rows_per_column;
        return fmt::format(
            "<line x1='0' x2='{}' y1='{:.2f}' y2='{:.2f}' stroke='{}' stroke-width='0.7'{}/>",
            width, y, y, line_colour, dashes);
    };
    return level(lines.base_row, "") + level(lines.visible_row, " stroke-dasharray='4 3'") +
           fmt::format(
               "<line x1='{0:.2f}' x2='{0:.2f}' y1='0' y2='{1:.1f}' stroke='{2}' "
               "stroke-width='0.5' stroke-dasharray='1 3'/>",
               lines.axis_column + 0.5, drawn, line_colour);
}

/// Pixels are drawn as they are on the tissue.
std::string picture(const FilmStrip::Shown& shown, const FilmLines& lines) {
    const double stretch = lines.rows_per_column;
    std::vector<std::uint8_t> grey;
    for (const float value : shown.frame.grey)
        grey.push_back(std::uint8_t(std::clamp(std::lround(value), 0L, 255L)));
    const Index width = shown.frame.width, height = shown.frame.height;
    const double drawn = height * stretch;
    return fmt::format(
        "<figure><svg viewBox='0 0 {0} {1:.1f}' role='img' aria-label='frame {2}'>"
        "<image href='data:image/png;base64,{3}' width='{0}' height='{1:.1f}' "
        "preserveAspectRatio='none' style='image-rendering:pixelated'/>{4}{5}{6}</svg>"
        "<figcaption>{7:.2f} s, frame {8}</figcaption></figure>",
        width, drawn, shown.number + 1, to_base64(png_of(width, height, grey)),
        instrument_lines(lines, width, drawn), lines_of(shown.outline, true, sure_colour, stretch),
        lines_of(shown.outline, false, guess_colour, stretch), shown.time_s, shown.number + 1);
}

}  // namespace

void FilmStrip::add(const GreyFrame& frame, const Outline& outline, double time_s) {
    const Index number = number_++;
    if (number % step_ != 0) return;
    if (shown_.size() == most_shown) {
        step_ *= 2;
        std::erase_if(shown_, [&](const Shown& one) { return one.number % step_ != 0; });
        if (number % step_ != 0) return;
    }
    shown_.push_back({number, time_s, frame, outline});
}

const char* const film_style =
    ".strip{display:grid;grid-template-columns:repeat(auto-fill,minmax(260px,1fr));"
    "gap:14px}.strip figure{margin:0}.strip svg{width:100%;display:block}"
    ".legend{display:flex;gap:18px;margin-bottom:10px}.legend i{display:inline-block;"
    "width:14px;height:3px;margin-right:6px;vertical-align:middle}";

std::string film_sections(const FilmStrip& strip, const std::vector<double>& seconds,
                          const std::vector<double>& apex_mm, const FilmLines& lines) {
    std::string pictures;
    for (const FilmStrip::Shown& shown : strip.shown()) pictures += picture(shown, lines);
    std::string curve;
    if (!seconds.empty()) {
        const auto [low, high] = std::minmax_element(apex_mm.begin(), apex_mm.end());
        const double edge = 0.05 + 0.05 * (*high - *low);
        Plot plot("travel", 640, 260,
                  {0, std::max(1e-3, seconds.back()), false, "time of the film, s"},
                  {*low - edge, *high + edge, false, "highest point, mm above the rim's face"});
        plot.curve(seconds, apex_mm, "var(--accent)", false);
        curve = "<div class='figures'><figure>" +
                plot.svg("Highest point of the tissue over time") + "</figure></div>";
    }
    return section_html("apex", "Travel", curve) +
           section_html("frames", "Frames",
                        legend_html({{"outline", sure_colour},
                                     {"guessed or lost", guess_colour},
                                     {"told of the instrument", line_colour}}) +
                            "<p class='caption'>Whole line: the rim's lower face, z = 0 "
                            "(base_row_px). Dashed: the rim hides what is below. Dotted: the axis. "
                            "If these are not where you see rim and middle, correct the settings."
                            "</p><div class='strip'>" +
                            pictures + "</div>");
}

}  // namespace palpate
