// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/contour_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <utility>

#include "host/apps/phantom/random_numbers.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr int num_waves = 400;
constexpr double largest_sd_mm = 2, shortest_mm = 1, longest_mm = 50;
constexpr double farthest_sd = 5;  ///< no contour is further off

constexpr std::array<std::pair<ContourStyle, const char*>, 6> style_names{
    {{ContourStyle::exact, "exact"},
     {ContourStyle::exponential, "exponential"},
     {ContourStyle::matern32, "matern32"},
     {ContourStyle::squared, "squared"},
     {ContourStyle::slices, "slices"},
     {ContourStyle::drawn, "drawn"}}};

double normal_number(RandomNumbers& random) {
    const double radius = std::sqrt(-2 * std::log(random.uniform(1e-300, 1)));
    return radius * std::cos(random.uniform(0, 2 * std::numbers::pi));
}

/// Of one wave, per mm, for l = 1: normal numbers, over the root of a chi-squared number with twice
/// the smoothness degrees of freedom where the kernel is of Matern's family.
Vec3 wave_vector(ContourStyle style, RandomNumbers& random) {
    const Vec3 normal(normal_number(random), normal_number(random), normal_number(random));
    const int freedom = style == ContourStyle::squared       ? 0
                        : style == ContourStyle::exponential ? 1
                                                             : 3;
    if (freedom == 0) return normal;
    double squares = 0;
    for (int k = 0; k < freedom; ++k) squares += std::pow(normal_number(random), 2);
    return normal * std::sqrt(freedom / squares);
}

/// How far one organ's contour lies outside its surface, mm.
class ContourError {
public:
    ContourError(const ContourErrorOptions& options, const ImageGrid& grid, std::uint64_t seed)
        : options_(options) {
        if (options.style != ContourStyle::slices) {
            whole_.emplace(options.style, options.length_mm, seed);
            return;
        }
        RandomNumbers random(seed ^ 0x736c6963ull);
        for (Index k = 0; k < grid.size[2]; ++k) {
            slices_.emplace_back(options.style, options.length_mm,
                                 seed + 7919ull * std::uint64_t(k + 1));
            shifts_.push_back(grid.direction *
                              Vec3(normal_number(random), normal_number(random), 0));
        }
        across_ = grid.direction.col(2);
    }

    double at(const Vec3& point, Index slice, const Vec3& normal) const {
        if (whole_) return options_.sd_mm * whole_->value(point);
        // What is drawn moves in its plane: along the surface's normal only its part counts.
        const Vec3 inplane = normal - normal.dot(across_) * across_;
        const Vec3 place = point - point.dot(across_) * across_;
        return options_.sd_mm * std::sqrt(0.5) *
               (inplane.norm() * slices_[slice].value(place) + inplane.dot(shifts_[slice]));
    }

private:
    ContourErrorOptions options_;
    std::optional<RandomField> whole_;
    std::vector<RandomField> slices_;
    std::vector<Vec3> shifts_;  ///< of each slice in its plane, standard deviation 1
    Vec3 across_ = Vec3::Zero();
};

/// A smoothed distance grows too slowly with the distance.
double steep(double level, const Vec3& gradient) { return level / std::max(gradient.norm(), 0.5); }

std::uint64_t seed_of(Index region, std::uint64_t seed) {
    return seed * 1000003ull + std::uint64_t(region) * 8191ull;
}

[[noreturn]] void refuse(const std::string& text) {
    throw Error(ErrorCode::invalid_argument,
                fmt::format("contours: '{}' is not understood; allowed: exact, or STYLE:SD:LENGTH "
                            "with STYLE one of exponential, matern32, squared, slices, SD of 0 to "
                            "{} mm and LENGTH of {} to {} mm, such as matern32:0.5:7, or drawn:SD",
                            text, largest_sd_mm, shortest_mm, longest_mm));
}

}  // namespace

ContourErrorOptions contour_error_of(const std::string& text) {
    if (text == "exact") return {};
    std::istringstream in(text);
    std::string name;
    char colon = 0;
    ContourErrorOptions options;
    std::getline(in, name, ':');
    in >> options.sd_mm;
    if (in && name != "drawn") in >> colon >> options.length_mm;
    if (!in || (name != "drawn" && colon != ':') || !(in.eof() || in.peek() == EOF)) refuse(text);
    for (const auto& [style, known] : style_names) {
        if (name == known) options.style = style;
    }
    const bool is_sensible = options.sd_mm >= 0 && options.sd_mm <= largest_sd_mm &&
                             options.length_mm >= shortest_mm && options.length_mm <= longest_mm;
    if (options.style == ContourStyle::exact || !is_sensible) refuse(text);
    return options;
}

std::string to_text(const ContourErrorOptions& options) {
    if (options.style == ContourStyle::exact) return "exact";
    if (options.style == ContourStyle::drawn) return fmt::format("drawn:{}", options.sd_mm);
    for (const auto& [style, name] : style_names) {
        if (style == options.style)
            return fmt::format("{}:{}:{}", name, options.sd_mm, options.length_mm);
    }
    return {};
}

ContourErrorOptions drawn_for(ContourErrorOptions options, unsigned seed) {
    if (options.style != ContourStyle::drawn) return options;
    RandomNumbers random(0x636f6e74ull * 1000003ull + seed);
    constexpr std::array styles{ContourStyle::exponential, ContourStyle::matern32,
                                ContourStyle::squared, ContourStyle::slices};
    options.style = styles[std::size_t(random.uniform(0, styles.size()))];
    options.length_mm = random.uniform(4, 12);
    return options;
}

RandomField::RandomField(ContourStyle style, double length_mm, std::uint64_t seed) {
    RandomNumbers random(seed);
    for (int k = 0; k < num_waves; ++k) {
        waves_.push_back(wave_vector(style, random) / length_mm);
        phases_.push_back(random.uniform(0, 2 * std::numbers::pi));
    }
}

double RandomField::value(const Vec3& point) const {
    double sum = 0;
    for (std::size_t k = 0; k < waves_.size(); ++k)
        sum += std::cos(waves_[k].dot(point) + phases_[k]);
    return sum * std::sqrt(2.0 / double(waves_.size()));
}

RegionImage drawn_regions(const LabelField& truth, const ImageGrid& grid,
                          const ContourErrorOptions& options, std::uint64_t seed) {
    std::vector<ContourError> errors;
    for (Index region = 0; region < truth.num_regions(); ++region)
        errors.emplace_back(options, grid, seed_of(region, seed));
    RegionImage drawn{grid, std::vector<std::uint8_t>(grid.num_voxels(), background_region)};
    const double reach = farthest_sd * options.sd_mm;
    parallel_ranges(grid.size[2], 1, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) {
            for (Index j = 0; j < grid.size[1]; ++j) {
                for (Index i = 0; i < grid.size[0]; ++i) {
                    const Vec3 point = grid.to_point(Vec3(i, j, k));
                    double deepest = 0;
                    for (Index region = first_organ_region; region < truth.num_regions();
                         ++region) {
                        if (truth.lower_bound(region, point) > reach) continue;
                        Vec3 normal;
                        double level = steep(truth.value(region, point, normal), normal);
                        if (options.style != ContourStyle::exact && std::abs(level) < reach)
                            level -= errors[region].at(point, k, normal.normalized());
                        if (level >= deepest) continue;
                        deepest = level;
                        drawn.at(i, j, k) = static_cast<std::uint8_t>(region);
                    }
                }
            }
        }
    });
    return drawn;
}

void draw_border(const LabelField& truth, Index whole, Index part,
                 const ContourErrorOptions& options, std::uint64_t seed, RegionImage& drawn) {
    const ImageGrid& grid = drawn.grid;
    const ContourError error(options, grid, seed_of(part, seed));
    parallel_ranges(grid.size[2], 1, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) {
            for (Index j = 0; j < grid.size[1]; ++j) {
                for (Index i = 0; i < grid.size[0]; ++i) {
                    if (drawn.at(i, j, k) != whole) continue;
                    const Vec3 point = grid.to_point(Vec3(i, j, k));
                    Vec3 normal;
                    const double level =
                        steep(truth.interface_value(part, whole, point, &normal), normal);
                    if (level < error.at(point, k, normal.normalized()))
                        drawn.at(i, j, k) = static_cast<std::uint8_t>(part);
                }
            }
        }
    });
}

}  // namespace palpate
