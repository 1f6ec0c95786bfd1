// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/cli/partial_target_options.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "host/geometry/surfaces/read_shapes.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Organ and file of ORGAN=FILE; organ names hold no equals sign that comes first.
std::pair<std::string, std::filesystem::path> split(const std::string& option,
                                                    const std::string& text) {
    const std::size_t at = text.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == text.size()) {
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("{} takes ORGAN=FILE, for example prostate=cloud.csv, not '{}'",
                                option, text));
    }
    return {text.substr(0, at), text.substr(at + 1)};
}

}  // namespace

void add_partial_target_options(CLI::App& command, PartialTargetArguments& arguments) {
    CLI::Option* labels = command.get_option("target");
    command
        .add_option("--target-surface", arguments.surfaces,
                    "ORGAN=FILE: that organ's surface in state two, open or closed, mm (.vtp .vtk "
                    ".ply .stl .obj); may be repeated")
        ->allow_extra_args(false);
    command
        .add_option("--target-points", arguments.points,
                    "ORGAN=FILE: points on that organ's surface in state two, mm (.csv .txt .xyz: "
                    "columns x y z; or the points of .vtp .vtk .ply); may be repeated")
        ->allow_extra_args(false);
    command
        .add_option("--target-frame", arguments.frame,
                    "Frame of the coordinates in these files: lps or ras")
        ->check(CLI::IsMember({"lps", "ras"}))
        ->excludes(labels)
        ->capture_default_str();
    command
        .add_option("--target-noise", arguments.noise_mm,
                    "Standard deviation of these surfaces and points, mm")
        ->check(CLI::Range(0.01, 20.0))
        ->excludes(labels)
        ->capture_default_str();
}

bool has_shapes(const PartialTargetArguments& arguments) {
    return !arguments.surfaces.empty() || !arguments.points.empty();
}

void check_one_kind_of_target(const std::vector<std::string>& label_volumes,
                              const PartialTargetArguments& arguments) {
    if (label_volumes.empty() != has_shapes(arguments)) {
        throw Error(ErrorCode::invalid_argument,
                    label_volumes.empty()
                        ? std::string("recover needs a target: a label volume, or "
                                      "--target-surface and --target-points for single organs")
                        : fmt::format("the target is either a label volume ('{}') or made of "
                                      "--target-surface and --target-points, not both",
                                      label_volumes.front()));
    }
}

PartialTarget partial_target(const PartialTargetArguments& arguments) {
    const Frame frame = arguments.frame == "ras" ? Frame::ras : Frame::lps;
    PartialTarget target;
    target.noise_mm = arguments.noise_mm;
    for (const auto& text : arguments.surfaces) {
        const auto [organ, file] = split("--target-surface", text);
        target.organs.push_back({organ, file.filename().string(), read_surface(file, frame)});
    }
    for (const auto& text : arguments.points) {
        const auto [organ, file] = split("--target-points", text);
        target.organs.push_back({organ, file.filename().string(), read_points(file, frame)});
    }
    return target;
}

}  // namespace palpate
