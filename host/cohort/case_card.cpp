// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/case_card.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/apps/recover/report/findings.hpp"
#include "host/geometry/surfaces/plane_section.hpp"

namespace palpate {
namespace {

constexpr double card_width = 600, gap = 12;  // units of the picture
constexpr double margin_mm = 6;
constexpr double tolerance = 0.8;  // units

constexpr const char* card_style =
    "path{fill:none;stroke-linejoin:round;stroke-linecap:round}.r{fill-opacity:.22}"
    ".t{stroke:#93a0ab;stroke-width:4.4}.m{stroke-width:2}"
    "text{font:11px system-ui,sans-serif;fill:#5a6670}"
    "@media(prefers-color-scheme:dark){.t{stroke:#77838d}text{fill:#9ba6af}}";

/// How a view lies in patient space: picture column and row axis, whether rows run upwards.
struct View {
    int column_axis, row_axis, through_axis;
    bool rows_up;
    const char* letters;  ///< left, top
};
constexpr View views[] = {{0, 1, 2, false, "RA"}, {0, 2, 1, true, "RS"}, {1, 2, 0, true, "AS"}};

struct Box {
    Vec3 low = Vec3::Constant(HUGE_VAL), high = Vec3::Constant(-HUGE_VAL);
    void take(const Surface& surface) {
        for (const Vec3& vertex : surface.vertices) {
            low = low.cwiseMin(vertex);
            high = high.cwiseMax(vertex);
        }
    }
};

/// Where a view lies on the card.
struct Panel {
    const View& view;
    const Box& box;
    double left, scale;  ///< units; units per mm

    double width() const { return scale * (box.high - box.low)[view.column_axis]; }
    double height() const { return scale * (box.high - box.low)[view.row_axis]; }
    std::array<long, 2> place(const Vec3& point) const {
        const int c = view.column_axis, r = view.row_axis;
        const double down = view.rows_up ? box.high[r] - point[r] : point[r] - box.low[r];
        return {std::lround(left + scale * (point[c] - box.low[c])), std::lround(scale * down)};
    }
};

/// Whole units, each step from the point before.
std::string path_data(const Panel& panel, const Surface& surface, double at_mm) {
    std::string data;
    for (const SectionLine& line : plane_section(surface, panel.view.through_axis, at_mm)) {
        std::array<long, 2> before{};
        const SectionLine points = thinned(line, tolerance / panel.scale);
        const bool is_closed = (line.front() - line.back()).norm() < tolerance / panel.scale;
        for (std::size_t k = 0; k + is_closed < points.size(); ++k) {
            const auto at = panel.place(points[k]);
            if (k == 0) {
                data += fmt::format("M{} {}l", at[0], at[1]);
            } else {
                const long dx = at[0] - before[0], dy = at[1] - before[1];
                data += fmt::format("{}{}{}{}", k > 1 && dx >= 0 ? " " : "", dx, dy >= 0 ? " " : "",
                                    dy);
            }
            before = at;
        }
        if (is_closed) data += "z";
    }
    return data;
}

std::string panel_svg(const std::vector<CardOrgan>& organs, const Panel& panel, const Vec3& at) {
    const double through = at[panel.view.through_axis];
    std::string out;
    const auto add = [&](const char* kind, const std::string& colour, const Surface& surface) {
        const std::string data = path_data(panel, surface, through);
        if (!data.empty()) out += fmt::format("<path class='{}'{} d='{}'/>", kind, colour, data);
    };
    for (const CardOrgan& organ : organs)
        add("r", fmt::format(" style='fill:{}'", organ.colour), organ.reference);
    for (const CardOrgan& organ : organs) add("t", "", organ.target);
    for (const CardOrgan& organ : organs)
        add("m", fmt::format(" stroke='{}'", organ.colour), organ.moved);
    return out + fmt::format(
                     "<text x='{:.0f}' y='{:.0f}'>{}</text><text x='{:.0f}' y='11' "
                     "text-anchor='middle'>{}</text>",
                     panel.left, panel.height() / 2, panel.view.letters[0],
                     panel.left + panel.width() / 2, panel.view.letters[1]);
}

Surface moved_surface(const SurfaceResult& surface, const RecoveryResult& result) {
    Surface moved = surface.reference;
    for (std::size_t v = 0; v < moved.vertices.size(); ++v)
        moved.vertices[v] += result.displacement[std::size_t(surface.node_of[v])];
    return moved;
}

bool is_unknown(const RecoveryResult& result, Index region) {
    return std::any_of(result.regions.begin(), result.regions.end(),
                       [&](const RegionResult& r) { return r.region == region && r.unknown; });
}

}  // namespace

std::string card_svg(const std::vector<CardOrgan>& organs, const Vec3& at) {
    Box box;
    for (const CardOrgan& organ : organs) {
        box.take(organ.moved);
        box.take(organ.target);
    }
    if (!(box.low[0] <= box.high[0])) return "";
    box.low.array() -= margin_mm;
    box.high.array() += margin_mm;
    const Vec3 size = box.high - box.low;
    const double scale = (card_width - 2 * gap) / (2 * size[0] + size[1]);
    std::string out;
    double left = 0, height = 0;
    for (const View& view : views) {
        const Panel panel{view, box, left, scale};
        out += panel_svg(organs, panel, at);
        left += panel.width() + gap;
        height = std::max(height, panel.height());
    }
    return fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {:.0f} {:.0f}'><style>"
        "{}</style>{}</svg>\n",
        card_width, std::ceil(height), card_style, out);
}

std::string case_card(const RecoveryResult& result) {
    std::vector<CardOrgan> organs;
    Vec3 sum = Vec3::Zero();
    double count = 0;
    const bool has_unknown = std::any_of(
        result.surfaces.begin(), result.surfaces.end(),
        [&](const SurfaceResult& surface) { return is_unknown(result, surface.region); });
    for (const SurfaceResult& surface : result.surfaces) {
        organs.push_back({region_colour(result, surface.region), surface.reference,
                          moved_surface(surface, result), surface.target});
        if (has_unknown && !is_unknown(result, surface.region)) continue;
        for (const Vec3& vertex : organs.back().moved.vertices) sum += vertex;
        count += double(surface.reference.vertices.size());
    }
    return count > 0 ? card_svg(organs, sum / count) : "";
}

}  // namespace palpate
