// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/run/target_shapes.hpp"

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

bool has_shapes(const OptionValues& values) {
    const std::vector<std::string> volumes = values.texts("target");
    const bool given = values.is_given("target_surface") || values.is_given("target_points");
    if (volumes.empty() == given) return given;
    throw Error(ErrorCode::invalid_argument,
                volumes.empty()
                    ? std::string("recover needs a target: a label volume, or "
                                  "--target-surface and --target-points for single organs")
                    : fmt::format("the target is either a label volume ('{}') or made of "
                                  "--target-surface and --target-points, not both",
                                  volumes.front()));
}

PartialTarget target_of_shapes(const OptionValues& values) {
    const Frame frame = values.text("target_frame") == "ras" ? Frame::ras : Frame::lps;
    PartialTarget target;
    target.noise_mm = values.number("target_noise");
    for (const auto& text : values.texts("target_surface")) {
        const auto [organ, file] = split("--target-surface", text);
        target.organs.push_back({organ, file.filename().string(), read_surface(file, frame)});
    }
    for (const auto& text : values.texts("target_points")) {
        const auto [organ, file] = split("--target-points", text);
        target.organs.push_back({organ, file.filename().string(), read_points(file, frame)});
    }
    return target;
}

}  // namespace palpate
