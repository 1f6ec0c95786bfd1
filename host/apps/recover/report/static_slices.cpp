// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/static_slices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/apps/recover/report/findings.hpp"
#include "host/page/markup.hpp"
#include "host/page/packing.hpp"
#include "host/page/png.hpp"

namespace palpate {
namespace {

/// How a view cuts the volume: picture column and row axis, and whether rows run upwards.
struct Cut {
    int column_axis, row_axis, through_axis;
    bool rows_up;
    const char* letters;  ///< left, right, top, bottom
    const char* name;
};

Cut cut_of(SliceView view) {
    switch (view) {
        case SliceView::axial:
            return {0, 1, 2, false, "RLAP", "Axial"};
        case SliceView::coronal:
            return {0, 2, 1, true, "RLSI", "Coronal"};
        case SliceView::sagittal:
            return {1, 2, 0, true, "APSI", "Sagittal"};
    }
    return {0, 1, 2, false, "RLAP", "Axial"};
}

/// One slice of one volume, as a mask of one organ at a time.
struct Slice {
    const LabelVolumes& volumes;
    const std::vector<std::uint8_t>& voxels;
    Cut cut;

    Index columns() const { return volumes.size[cut.column_axis]; }
    Index rows() const { return volumes.size[cut.row_axis]; }
    int value(Index column, Index row) const {
        if (column < 0 || row < 0 || column >= columns() || row >= rows()) return 0;
        std::array<Index, 3> at = volumes.centre;
        at[cut.column_axis] = column;
        at[cut.row_axis] = cut.rows_up ? rows() - 1 - row : row;
        return voxels[volumes.offset(at[0], at[1], at[2])];
    }
};

/// Marching squares between pixel centres: the outline of `organ` as short strokes, in pixels.
std::string outline_path(const Slice& slice, int organ) {
    // Edge midpoints of a cell: top, right, bottom, left; pairs of edges by corner pattern.
    static constexpr double mid[4][2] = {{0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};
    static constexpr int strokes[16][4] = {
        {-1, -1, -1, -1}, {3, 0, -1, -1}, {0, 1, -1, -1}, {3, 1, -1, -1},
        {1, 2, -1, -1},   {3, 0, 1, 2},   {0, 2, -1, -1}, {3, 2, -1, -1},
        {2, 3, -1, -1},   {2, 0, -1, -1}, {0, 1, 2, 3},   {2, 1, -1, -1},
        {1, 3, -1, -1},   {1, 0, -1, -1}, {0, 3, -1, -1}, {-1, -1, -1, -1}};
    std::string path;
    for (Index r = -1; r < slice.rows(); ++r)
        for (Index c = -1; c < slice.columns(); ++c) {
            const int pattern =
                (slice.value(c, r) == organ) | (slice.value(c + 1, r) == organ) << 1 |
                (slice.value(c + 1, r + 1) == organ) << 2 | (slice.value(c, r + 1) == organ) << 3;
            for (int s = 0; s < 4 && strokes[pattern][s] >= 0; s += 2) {
                const auto* a = mid[strokes[pattern][s]];
                const auto* b = mid[strokes[pattern][s + 1]];
                path += fmt::format("M{} {}L{} {}", c + 0.5 + a[0], r + 0.5 + a[1], c + 0.5 + b[0],
                                    r + 0.5 + b[1]);
            }
        }
    return path;
}

/// The area of `organ` as horizontal bars, in pixels.
std::string area_path(const Slice& slice, int organ) {
    std::string path;
    for (Index r = 0; r < slice.rows(); ++r)
        for (Index c = 0; c < slice.columns();) {
            if (slice.value(c, r) != organ) {
                ++c;
                continue;
            }
            const Index first = c;
            while (c < slice.columns() && slice.value(c, r) == organ) ++c;
            path += fmt::format("M{} {}h{}v1h{}z", first, r, c - first, first - c);
        }
    return path;
}

/// The slice of a picture that lies where the volumes' slice does, between two of its own; rows
/// from the top.
struct GreySlice {
    Index columns = 0, rows = 0;
    std::vector<std::uint8_t> pixels;
};

GreySlice cut_picture(const GreyPicture& picture, const LabelVolumes& volumes, const Cut& cut) {
    GreySlice slice{picture.size[cut.column_axis], picture.size[cut.row_axis], {}};
    const int through = cut.through_axis;
    const Index last = picture.size[through] - 1;
    const double place = (volumes.centre[through] + 0.5) / volumes.size[through];
    const double depth = std::clamp(place * picture.size[through] - 0.5, 0.0, double(last));
    const auto low = static_cast<Index>(depth);
    const double part = depth - low;
    for (Index r = 0; r < slice.rows; ++r)
        for (Index c = 0; c < slice.columns; ++c) {
            std::array<Index, 3> at{};
            at[cut.column_axis] = c;
            at[cut.row_axis] = cut.rows_up ? slice.rows - 1 - r : r;
            const auto grey = [&](Index depth_index) {
                at[through] = std::min(depth_index, last);
                return double(picture.voxels[picture.offset(at[0], at[1], at[2])]);
            };
            slice.pixels.push_back(static_cast<std::uint8_t>(
                std::lround((1 - part) * grey(low) + part * grey(low + 1))));
        }
    return slice;
}

/// `width` and `height` in mm.
std::string picture_svg(const GreyPicture& picture, const LabelVolumes& volumes, const Cut& cut,
                        double width, double height) {
    const GreySlice slice = cut_picture(picture, volumes, cut);
    return fmt::format(
        "<image href='data:image/png;base64,{}' width='{:.2f}' height='{:.2f}' "
        "preserveAspectRatio='none'/>",
        to_base64(png_of(slice.columns, slice.rows, slice.pixels)), width, height);
}

std::string coloured_lines(const Slice& slice, int organ, const std::string& colour) {
    return fmt::format("<path class='warped-line' d='{}' style='stroke:{}'/>",
                       outline_path(slice, organ), colour);
}

const GreyPicture* picture_of(const ShownPictures& pictures, SliceGround ground) {
    if (ground == SliceGround::plain) return nullptr;
    return ground == SliceGround::target ? &pictures.target.grey : &pictures.reference.grey;
}

const char* name_of(SliceGround ground) {
    switch (ground) {
        case SliceGround::reference:
            return ", reference image";
        case SliceGround::target:
            return ", target image";
        case SliceGround::plain:
            break;
    }
    return "";
}

}  // namespace

std::string static_slice_svg(const RecoveryResult& result, const LabelVolumes& volumes,
                             SliceView view, const ShownPictures& pictures, SliceGround ground) {
    const Cut cut = cut_of(view);
    const Slice reference{volumes, volumes.reference, cut}, target{volumes, volumes.target, cut},
        warped{volumes, volumes.warped, cut};
    const double sx = volumes.spacing[cut.column_axis], sy = volumes.spacing[cut.row_axis];
    const double width = sx * reference.columns(), height = sy * reference.rows();
    const GreyPicture* picture = picture_of(pictures, ground);
    std::string out;
    for (std::size_t v = 1; v <= volumes.regions.size(); ++v) {
        const int organ = static_cast<int>(v);
        const std::string colour = region_colour(result, volumes.regions[v - 1]);
        if (ground == SliceGround::reference) {
            out += coloured_lines(reference, organ, colour);
            continue;
        }
        if (!picture)
            out += fmt::format("<path d='{}' style='fill:{};fill-opacity:.32'/>",
                               area_path(reference, organ), colour);
        out += fmt::format("<path class='target-line' d='{}'/>", outline_path(target, organ));
        out += coloured_lines(warped, organ, colour);
    }
    return fmt::format(
        "<svg class='slice{14}' viewBox='0 0 {0:.2f} {1:.2f}' role='img' aria-label='{2} slice'>"
        "{15}<g transform='scale({3} {4})'>{5}</g><g class='letters'><text x='3' y='{6:.1f}'>{7}"
        "</text><text x='{8:.1f}' y='{6:.1f}' text-anchor='end'>{9}</text><text x='{10:.1f}' y='6' "
        "text-anchor='middle'>{11}</text><text x='{10:.1f}' y='{12:.1f}' text-anchor='middle'>"
        "{13}</text></g></svg>",
        width, height, cut.name, sx, sy, out, height / 2, cut.letters[0], width - 3, cut.letters[1],
        width / 2, cut.letters[2], height - 3, cut.letters[3], picture ? " on-picture" : "",
        picture ? picture_svg(*picture, volumes, cut, width, height) : "");
}

std::string slice_figures(const RecoveryResult& result, const LabelVolumes& volumes,
                          const ShownPictures& pictures, SliceGround ground,
                          const std::string& kind) {
    const auto length_mm = [&](int a) { return volumes.spacing[a] * volumes.size[a]; };
    constexpr double little_more = 1.1;
    const bool flat = !pictures.empty() && 2 * length_mm(2) < little_more * length_mm(1);
    std::string out = fmt::format(
        "<div class='slices{0}{1}' style='--x:{2:.1f};--y:{3:.1f};--wide:{4:.1f};"
        "--columns:minmax(0,{2:.1f}fr) minmax(0,{4:.1f}fr)'>",
        flat ? " flat" : "", kind.empty() ? "" : " " + kind, length_mm(0), length_mm(1),
        std::max(length_mm(0), length_mm(1)));
    for (const auto& [view, id] : {std::pair{SliceView::axial, "axial"},
                                   {SliceView::coronal, "coronal"},
                                   {SliceView::sagittal, "sagittal"}})
        out += fmt::format(
            "<figure data-view='{}'><figcaption><span>{}<span class='ground'>{}</span></span>"
            "</figcaption><div class='frame'>{}</div></figure>",
            id, cut_of(view).name, name_of(ground),
            volumes.empty() ? "" : static_slice_svg(result, volumes, view, pictures, ground));
    return out + "</div>";
}

std::vector<SliceGround> slice_grounds(const ShownPictures& pictures) {
    std::vector<SliceGround> grounds;
    if (!pictures.target.empty()) grounds.push_back(SliceGround::target);
    if (!pictures.reference.empty()) grounds.push_back(SliceGround::reference);
    grounds.push_back(SliceGround::plain);
    return grounds;
}

}  // namespace palpate
