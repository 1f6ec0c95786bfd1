// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/landmarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::optional<std::size_t> column_of_names(const PointTable& table) {
    if (!table.header) return std::nullopt;
    for (std::size_t c = 0; c < table.header->size(); ++c) {
        std::string name = (*table.header)[c];
        std::ranges::transform(name, name.begin(), [](unsigned char x) { return std::tolower(x); });
        if (name == "name" || name == "label") return c;
    }
    return std::nullopt;
}

void check_names(const PointTable& reference, const PointTable& target,
                 const std::filesystem::path& path) {
    const auto here = column_of_names(reference), there = column_of_names(target);
    if (!here || !there) return;
    for (std::size_t row = 0; row < reference.rows.size(); ++row) {
        const std::string& a = reference.rows[row].at(*here);
        const std::string& b = target.rows[row].at(*there);
        if (a != b)
            throw Error(ErrorCode::input_unusable,
                        fmt::format("{}: landmark {} is called '{}', but '{}' in the reference; "
                                    "the same landmarks must stand in the same rows",
                                    path.string(), row + 1, b, a));
    }
}

}  // namespace

std::vector<Landmark> read_landmarks(const std::filesystem::path& reference,
                                     const std::filesystem::path& target, PointAxes axes) {
    const PointTable here = read_points(reference, axes), there = read_points(target, axes);
    if (here.points.size() != there.points.size())
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{} has {} landmarks, {} has {}; each needs its partner in the "
                                "same row",
                                reference.string(), here.points.size(), target.string(),
                                there.points.size()));
    check_names(here, there, target);
    std::vector<Landmark> landmarks;
    for (std::size_t row = 0; row < here.points.size(); ++row)
        landmarks.push_back({here.points[row], there.points[row]});
    return landmarks;
}

std::vector<LandmarkResult> measure_landmarks(const std::vector<Landmark>& landmarks,
                                              const Image<Vec3>& field,
                                              const RigidTransform& reference_to_target) {
    const PointMap map{field, false};
    std::vector<LandmarkResult> results;
    for (const Landmark& landmark : landmarks) {
        const MovedPoint moved = map.moved(landmark.reference);
        results.push_back({landmark,
                           (reference_to_target.apply(landmark.reference) - landmark.target).norm(),
                           (moved.point - landmark.target).norm(), moved.inside && moved.found});
    }
    return results;
}

}  // namespace palpate
