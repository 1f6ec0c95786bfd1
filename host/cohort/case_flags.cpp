// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/case_flags.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {
namespace {

struct FlagTerms {
    const char* name;
    int weight;
};
constexpr std::array<FlagTerms, num_case_flags> terms{{{"failed", 0},
                                                       {"not converged", 60},
                                                       {"mesh folds", 40},
                                                       {"images are the same", 40},
                                                       {"surface far from target", 16},
                                                       {"overlap below 0.95", 14},
                                                       {"unlike the patient's other pairs", 12},
                                                       {"volume of an organ changed", 10},
                                                       {"images contradict what was expected", 8},
                                                       {"not identifiable", 6},
                                                       {"cut by the image", 5},
                                                       {"second mesher", 3},
                                                       {"weak", 2},
                                                       {"slow", 1}}};

constexpr double far_off_voxels = 0.5, least_dice = 0.95, most_volume_change = 0.3;
constexpr double same_voxels = 0.001;
constexpr double most_robust_z = 3.5, mad_to_sd = 1.4826, least_sd_ln = 0.05;
constexpr std::size_t fewest_to_compare = 5;

double voxel_edge_mm(const RecoveryResult& result) {
    return std::cbrt(result.displacement_field.grid.spacing.prod());
}

/// Of tissue: loaded organs fill and empty.
bool has_other_volume(const SurfaceResult& surface) {
    if (surface.role != Role::tissue || surface.cut_by_image || surface.target_kind != "labels")
        return false;
    const double before = enclosed_volume(surface.reference);
    const double after = enclosed_volume(surface.target);
    return before > 0 && after > 0 && std::abs(after / before - 1) > most_volume_change;
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2) return *middle;
    return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

}  // namespace

const char* name_of(CaseFlag flag) { return terms.at(static_cast<std::size_t>(flag)).name; }

std::optional<CaseFlag> case_flag_of(std::string_view name) {
    for (std::size_t k = 0; k < terms.size(); ++k)
        if (name == terms[k].name) return static_cast<CaseFlag>(k);
    return std::nullopt;
}

int badness(CaseFlags flags) {
    if (flags.has(CaseFlag::failed)) return -1;
    int sum = 0;
    for (std::size_t k = 0; k < terms.size(); ++k)
        if (flags.has(static_cast<CaseFlag>(k))) sum += terms[k].weight;
    return sum;
}

CaseFlags flags_of_result(const RecoveryResult& result) {
    CaseFlags flags;
    const double voxel = voxel_edge_mm(result);
    if (!result.termination.converged) flags.add(CaseFlag::not_converged);
    if (!result.mesher.fallback.empty()) flags.add(CaseFlag::other_mesher);
    for (const RegionResult& region : result.regions) {
        if (!region.hollow && region.jacobian_range[0] <= 0) flags.add(CaseFlag::folded);
        if (!region.unknown) continue;
        if (region.contradicts_prior) flags.add(CaseFlag::contradicts_prior);
        if (region.verdict == Verdict::weak) flags.add(CaseFlag::weak);
        if (region.verdict == Verdict::not_identifiable) flags.add(CaseFlag::not_identifiable);
    }
    double most_before = 0;
    for (const SurfaceResult& surface : result.surfaces) {
        most_before = std::max(most_before, surface.max_distance_mm_before);
        if (surface.mean_distance_mm_after > far_off_voxels * voxel) flags.add(CaseFlag::far_off);
        if (surface.dice_after < least_dice) flags.add(CaseFlag::low_overlap);
        if (surface.cut_by_image) flags.add(CaseFlag::cut_by_image);
        if (has_other_volume(surface)) flags.add(CaseFlag::volume_changed);
    }
    const bool has_overlap =
        std::all_of(result.surfaces.begin(), result.surfaces.end(),
                    [](const SurfaceResult& surface) { return surface.dice_before == 1; });
    if (!result.surfaces.empty() && (has_overlap || most_before < same_voxels * voxel))
        flags.add(CaseFlag::same_images);
    return flags;
}

std::vector<bool> unlike_the_others(const std::vector<double>& ln_e) {
    std::vector<bool> unlike(ln_e.size(), false);
    if (ln_e.size() < fewest_to_compare) return unlike;
    const double median = median_of(ln_e);
    std::vector<double> off;
    for (const double value : ln_e) off.push_back(std::abs(value - median));
    const double sd = std::max(mad_to_sd * median_of(off), least_sd_ln);
    for (std::size_t k = 0; k < ln_e.size(); ++k) unlike[k] = off[k] > most_robust_z * sd;
    return unlike;
}

}  // namespace palpate
