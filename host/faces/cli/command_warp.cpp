// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/output_file.hpp"
#include "host/geometry/warping/field_files.hpp"
#include "host/geometry/warping/moved_grid.hpp"
#include "host/geometry/warping/point_table.hpp"
#include "host/geometry/warping/warp_volume.hpp"
#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/io/volume_files.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct WarpArguments {
    std::string field, input, like, out;
    bool inverse = false, overwrite = false, ras = false;
    Interpolation interpolation = Interpolation::linear;
    float fill = 0;
    double every_mm = 10;
};

const std::map<std::string, Interpolation> image_interpolations{{"nearest", Interpolation::nearest},
                                                                {"linear", Interpolation::linear},
                                                                {"cubic", Interpolation::cubic}};
const std::map<std::string, Interpolation> label_interpolations{{"nearest", Interpolation::nearest},
                                                                {"smooth", Interpolation::smooth}};

/// Points go this way; an image is fetched the other way.
PointMap map_of(const WarpArguments& arguments, bool fetches) {
    const bool forward = arguments.inverse == fetches;
    return read_point_map(arguments.field,
                          forward ? Sense::reference_to_target : Sense::target_to_reference);
}

/// What is odd about a file but was accepted.
void say(const std::string& file, const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) fmt::print(stderr, "{}: {}\n", file, warning);
}

ImageGrid grid_of(const WarpArguments& arguments, const PointMap& map) {
    if (arguments.like.empty()) return map.field.grid;
    std::vector<std::string> warnings;
    const ImageGrid grid = read_image_grid(arguments.like, &warnings);
    say(arguments.like, warnings);
    return grid;
}

void say(const OutsideCounts& outside, std::size_t num_voxels, const std::string& fill) {
    if (outside.field > 0) {
        fmt::print(
            "{} of {} voxels lie outside the displacement field, which was continued from "
            "its border\n",
            outside.field, num_voxels);
    }
    if (outside.folded > 0) {
        fmt::print(
            "{} of {} voxels lie where the displacement field folds and could not be inverted: "
            "they show the nearest that was found\n",
            outside.folded, num_voxels);
    }
    if (outside.image > 0) {
        fmt::print("{} of {} voxels show what lies outside the input and hold {}\n", outside.image,
                   num_voxels, fill);
    }
}

int warp_one_image(const WarpArguments& arguments) {
    std::vector<std::string> warnings;
    const Image<float> image = read_scalar_image(arguments.input, &warnings);
    say(arguments.input, warnings);
    const PointMap back = map_of(arguments, true);
    const auto warped =
        warp_image(image, back, grid_of(arguments, back), arguments.interpolation, arguments.fill);
    write_scalar_image(arguments.out, warped.image);
    say(warped.outside, warped.image.voxels.size(), fmt::format("{}", arguments.fill));
    return 0;
}

int warp_one_label_image(const WarpArguments& arguments) {
    std::vector<std::string> warnings;
    const LabelImage labels = read_label_image(arguments.input, {}, &warnings);
    say(arguments.input, warnings);
    const PointMap back = map_of(arguments, true);
    const auto warped =
        warp_labels(labels, back, grid_of(arguments, back), arguments.interpolation);
    write_label_image(arguments.out, warped.image);
    say(warped.outside, warped.image.voxels.size(), "label 0");
    return 0;
}

int warp_points(const WarpArguments& arguments) {
    const PointAxes axes = arguments.ras ? PointAxes::ras : PointAxes::lps;
    const PointTable table = read_points(arguments.input, axes);
    const PointMap map = map_of(arguments, false);
    std::vector<MovedPoint> moved;
    std::size_t outside = 0, folded = 0;
    for (const Vec3& point : table.points) {
        moved.push_back(map.moved(point));
        outside += moved.back().found && !moved.back().inside;
        folded += !moved.back().found;
    }
    write_atomically(arguments.out, [&](const fs::path& temporary) {
        write_text_file(temporary, points_csv(table, moved, axes));
    });
    if (outside > 0) {
        fmt::print(
            "{} of {} points lie outside the displacement field (column inside = 0) and were "
            "moved as its border is\n",
            outside, moved.size());
    }
    if (folded > 0) {
        fmt::print(
            "{} of {} points lie where the displacement field folds and could not be inverted "
            "(column inside = 0): they were moved to the nearest that was found\n",
            folded, moved.size());
    }
    return 0;
}

int warp_grid(const WarpArguments& arguments) {
    const PointMap map = map_of(arguments, false);
    // Of the state that the lines start in; where only the other's field is there, of that.
    write_moved_grid(arguments.out, moved_grid(map, grid_of(arguments, map), arguments.every_mm));
    return 0;
}

/// A kind of thing that can be carried, with the options that all kinds have.
CLI::App* add_kind(CLI::App& warp, Run& run, const char* name, const char* what,
                   const std::shared_ptr<WarpArguments>& arguments,
                   int (*action)(const WarpArguments&)) {
    CLI::App* kind = warp.add_subcommand(name, what);
    kind->add_option("field", arguments->field,
                     "Result folder of `palpate recover`, or a displacement field (.nii.gz, .h5)")
        ->required();
    kind->add_flag("--inverse", arguments->inverse, "From the target to the reference");
    kind->add_option("--out", arguments->out, "File to write")->required();
    kind->add_flag("--overwrite", arguments->overwrite, "Replace an older file");
    kind->callback([arguments, action, &run] {
        run = [arguments, action] {
            check_output_file(arguments->out, arguments->overwrite);
            return action(*arguments);
        };
    });
    return kind;
}

void add_like(CLI::App& kind, const std::shared_ptr<WarpArguments>& arguments, const char* what) {
    kind.add_option("--like", arguments->like, what);
}

void add_image(CLI::App& warp, Run& run) {
    auto arguments = std::make_shared<WarpArguments>();
    CLI::App* kind =
        add_kind(warp, run, "image", "A volume of numbers, written in single precision", arguments,
                 warp_one_image);
    kind->add_option("image", arguments->input, "Volume to carry")->required();
    add_like(*kind, arguments, "Volume whose grid the result has; else that of the field");
    kind->add_option("--interpolation", arguments->interpolation, "linear, nearest or cubic")
        ->transform(CLI::CheckedTransformer(image_interpolations))
        ->default_str("linear");
    kind->add_option("--fill", arguments->fill, "Value outside the input")->capture_default_str();
}

void add_labels(CLI::App& warp, Run& run) {
    auto arguments = std::make_shared<WarpArguments>();
    arguments->interpolation = Interpolation::smooth;
    CLI::App* kind =
        add_kind(warp, run, "labels", "A label volume", arguments, warp_one_label_image);
    kind->add_option("labels", arguments->input, "Label volume to carry")->required();
    add_like(*kind, arguments, "Volume whose grid the result has; else that of the field");
    kind->add_option("--interpolation", arguments->interpolation,
                     "smooth (between smoothed surfaces) or nearest (label by label)")
        ->transform(CLI::CheckedTransformer(label_interpolations))
        ->default_str("smooth");
}

void add_points(CLI::App& warp, Run& run) {
    auto arguments = std::make_shared<WarpArguments>();
    CLI::App* kind = add_kind(warp, run, "points", "Points of a CSV file (x, y, z in mm)",
                              arguments, warp_points);
    kind->add_option("points", arguments->input, "CSV file; other columns are kept")->required();
    kind->add_flag("--ras", arguments->ras, "The file is RAS, not LPS; so is the result");
}

void add_grid(CLI::App& warp, Run& run) {
    auto arguments = std::make_shared<WarpArguments>();
    CLI::App* kind = add_kind(warp, run, "grid", "A picture: straight lines, moved (.vtp)",
                              arguments, warp_grid);
    add_like(*kind, arguments, "Volume whose grid the lines follow; else that of the field");
    kind->add_option("--every-mm", arguments->every_mm, "Distance of the lines")
        ->capture_default_str();
}

}  // namespace

void add_warp(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand(
        "warp", "Carry images, labels, points or a grid from the reference to the target");
    command->require_subcommand(1);
    add_image(*command, run);
    add_labels(*command, run);
    add_points(*command, run);
    add_grid(*command, run);
}

}  // namespace palpate
