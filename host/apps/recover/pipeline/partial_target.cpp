// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/partial_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "host/geometry/surfaces/picture_surface.hpp"
#include "host/geometry/surfaces/point_shape.hpp"
#include "host/geometry/surfaces/surface_shape.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// A shape this much smaller than its organ shows too little of it, or is in another unit.
constexpr double least_size = 0.03;

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::invalid_argument, why); }

std::string matched_names(const Settings& settings) {
    std::string names;
    for (const auto& organ : settings.organs) {
        if (organ.role != Role::fixed) names += (names.empty() ? "'" : ", '") + organ.name + "'";
    }
    return names;
}

const OrganSettings* organ_named(const Settings& settings, const std::string& name) {
    const auto found = std::find_if(settings.organs.begin(), settings.organs.end(),
                                    [&](const auto& organ) { return organ.name == name; });
    return found == settings.organs.end() ? nullptr : &*found;
}

const std::vector<Vec3>& points_of(const OrganTarget& given) {
    const auto* surface = std::get_if<Surface>(&given.shape);
    return surface ? surface->vertices : std::get<std::vector<Vec3>>(given.shape);
}

OrganTarget moved(OrganTarget given, const RigidTransform& transform) {
    auto* surface = std::get_if<Surface>(&given.shape);
    for (Vec3& x : surface ? surface->vertices : std::get<std::vector<Vec3>>(given.shape)) {
        x = transform.apply(x);
    }
    return given;
}

double diagonal(const std::vector<Vec3>& points) {
    Vec3 low = points.front(), high = points.front();
    for (const Vec3& x : points) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    return (high - low).norm();
}

/// Of the voxels of a region, corner to corner.
double diagonal(const LabelField& field, Index region) {
    const auto [first, last] = field.voxel_box(region);
    Vec3 length;
    for (int a = 0; a < 3; ++a) length[a] = (last[a] - first[a] + 1) * field.grid().spacing[a];
    return length.norm();
}

/// From the box round the voxels of a region.
double distance_to_box(const LabelField& field, Index region, const Vec3& point) {
    const auto [first, last] = field.voxel_box(region);
    const Vec3 index = field.grid().to_index(point);
    Vec3 beyond;
    for (int a = 0; a < 3; ++a) {
        beyond[a] = index[a] - std::clamp(index[a], double(first[a]), double(last[a]));
    }
    return beyond.cwiseProduct(field.grid().spacing).norm();
}

/// Median over the points, their axes turned by `signs`.
double median_distance(const LabelField& field, Index region, const std::vector<Vec3>& points,
                       const Vec3& signs) {
    std::vector<double> distance;
    for (const Vec3& x : points) {
        distance.push_back(distance_to_box(field, region, x.cwiseProduct(signs)));
    }
    const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
    std::nth_element(distance.begin(), middle, distance.end());
    return *middle;
}

/// A shape has about the place and the size of its organ.
void check_place(const OrganTarget& given, const LabelField& field, Index region) {
    const auto& points = points_of(given);
    const double organ = diagonal(field, region), size = diagonal(points);
    const double away = median_distance(field, region, points, Vec3::Ones());
    if (away <= organ && size >= least_size * organ) return;
    std::string remedy =
        "check that it is in mm, LPS and the reference's frame, or give --initial-transform";
    if (1000 * size > 0.1 * organ && 1000 * size < 3 * organ) {
        remedy = "it looks like metres: multiply its coordinates by 1000";
    } else if (median_distance(field, region, points, Vec3(-1, -1, 1)) <= 0.5 * organ) {
        remedy = "it looks like the other frame: try --target-frame ras (lps if it was ras)";
    }
    throw Error(ErrorCode::input_unusable,
                fmt::format("the target '{}' is {:.3g} mm large and {:.3g} mm away from its organ "
                            "'{}', which is {:.3g} mm large; {}",
                            given.name, size, away, given.organ, organ, remedy));
}

ShownSurface shown_surface(OrganTarget given, const Outward& outward, double noise_mm) {
    if (auto* surface = std::get_if<Surface>(&given.shape)) {
        const Surface turned = oriented_outward(std::move(*surface), outward);
        return {"surface", std::make_shared<SurfaceShape>(turned), turned};
    }
    const auto shape = std::make_shared<PointShape>(
        std::move(std::get<std::vector<Vec3>>(given.shape)), outward, noise_mm);
    return {"points", shape, picture_of_points(shape->points(), shape->spacing_mm())};
}

}  // namespace

void check_partial_target(const PartialTarget& target, const RecoverOptions& options) {
    if (target.organs.empty()) refuse("a target needs a label volume, or a surface or points");
    if (options.method == SearchMethod::nested_lbfgs) {
        refuse("--method nested-lbfgs needs a target label volume; use --method map");
    }
    if (options.initial_transform.empty() && options.align != AlignMethod::automatic &&
        options.align != AlignMethod::none) {
        refuse(
            "--align fixed and --align centroid need a target label volume; a target of "
            "surfaces or points takes --align none or --initial-transform");
    }
    std::set<std::string> names;
    for (const auto& given : target.organs) {
        const OrganSettings* organ = organ_named(options.settings, given.organ);
        const std::string matched = matched_names(options.settings);
        if (!organ) {
            refuse(fmt::format("the settings have no organ '{}' for the target '{}'; there are {}",
                               given.organ, given.name, matched));
        }
        if (organ->role == Role::fixed) {
            refuse(
                fmt::format("organ '{}' is fixed, so the target '{}' would carry no data; leave "
                            "it out, or give one of {}",
                            given.organ, given.name, matched));
        }
        if (!names.insert(given.organ).second) {
            refuse(
                fmt::format("organ '{}' has two targets, '{}' is the second; give one surface "
                            "or one cloud of points for each organ",
                            given.organ, given.name));
        }
    }
}

TargetState place_target(const PartialTarget& target, const ReferenceState& reference,
                         const RecoverOptions& options) {
    TargetState state;
    state.alignment = {"none", {}, 0};
    if (!options.initial_transform.empty()) {
        state.alignment = {"transform", read_rigid_transform(options.initial_transform), 0};
    }
    state.noise_mm = target.noise_mm;
    const RigidTransform back = state.alignment.reference_to_target.inverse();
    const LabelField& field = reference.state.field;
    const Settings& settings = options.settings;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (settings.organs[k].role == Role::fixed) continue;
        const Index region = first_organ_region + static_cast<Index>(k);
        const auto outward = [&field, region](const Vec3& x) {
            Vec3 gradient;
            field.value(region, x, gradient);
            return gradient;
        };
        state.shown.emplace_back();
        for (const auto& given : target.organs) {
            if (given.organ != settings.organs[k].name) continue;
            const OrganTarget placed = moved(given, back);
            check_place(placed, field, region);
            state.shown.back() = shown_surface(placed, outward, target.noise_mm);
            state.name += (state.name.empty() ? "" : ", ") + given.name;
        }
    }
    return state;
}

}  // namespace palpate
