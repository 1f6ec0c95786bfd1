// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/page/markup.hpp"
#include "host/page/solver_figures.hpp"

namespace palpate {
namespace {

/// A reason as a sentence of its own, with a blank before it.
std::string as_sentence(std::string text) {
    if (text.empty()) return "";
    if (text[0] >= 'a' && text[0] <= 'z') text[0] += 'A' - 'a';
    return " " + text + (text.back() == '.' ? "" : ".");
}

std::string interval_text(const RegionResult& r) {
    return fmt::format("95 % interval {} to {} kPa", significant(r.interval_kpa[0]),
                       significant(r.interval_kpa[1]));
}

bool is_observed(const SurfaceResult& s) {
    return s.role == Role::tissue || s.role == Role::driven;
}

bool is_grey(const RegionResult& r) { return r.role == Role::fixed || r.role == Role::background; }

}  // namespace

std::string region_name(const RecoveryResult& result, Index region) {
    for (const RegionResult& r : result.regions)
        if (r.region == region) return r.name;
    return fmt::format("region {}", region);
}

std::string region_colour(const RecoveryResult& result, Index region) {
    std::size_t position = 0;
    for (const RegionResult& r : result.regions) {
        if (r.region == region) {
            if (is_grey(r)) return neutral_colour;
            return list_colour(position);
        }
        if (!is_grey(r)) ++position;
    }
    return neutral_colour;
}

bool is_known(const RegionResult& region) { return region.verdict != Verdict::not_identifiable; }

double total_seconds(const RecoveryResult& result) {
    double total = 0;
    for (const auto& [stage, seconds] : result.timings_s)
        if (std::isfinite(seconds)) total += seconds;
    return total;
}

const RegionResult* reference_tissue(const RecoveryResult& result) {
    const RegionResult* best = nullptr;
    for (const RegionResult& r : result.regions) {
        if (r.hollow || r.unknown || !(r.stiffness_kpa > 0)) continue;
        if (r.role == Role::background) return &r;
        if (!best) best = &r;
    }
    return best;
}

std::string bound_text(const RegionResult& r) {
    const auto& [lower, upper] = r.seen_ends;
    if (lower == upper) return "";
    return fmt::format("{} {} kPa (the {} end, {} kPa, is what was assumed beforehand)",
                       lower ? "at least" : "at most", significant(r.interval_kpa[lower ? 0 : 1]),
                       lower ? "upper" : "lower", significant(r.interval_kpa[lower ? 1 : 0]));
}

std::string finding_sentence(const RecoveryResult& result, const RegionResult& r) {
    if (r.verdict == Verdict::not_identifiable)
        return fmt::format("The stiffness of {} cannot be told from these images.{}", r.name,
                           as_sentence(r.reason));
    if (const std::string bound = bound_text(r); !bound.empty())
        return fmt::format("{}: {}. In one number: {} kPa. Verdict: {}.{}", r.name, bound,
                           significant(r.stiffness_kpa), name_of(r.verdict), as_sentence(r.reason));
    std::string text =
        fmt::format("{}: {} kPa ({})", r.name, significant(r.stiffness_kpa), interval_text(r));
    if (const RegionResult* known = reference_tissue(result))
        text += fmt::format(", {} times {} ({} kPa, given)",
                            significant(r.stiffness_kpa / known->stiffness_kpa), known->name,
                            significant(known->stiffness_kpa));
    return text + fmt::format(". Verdict: {}.{}", name_of(r.verdict), as_sentence(r.reason));
}

std::string ratio_sentence(const RegionResult& r) {
    if (r.ratio->verdict == Verdict::not_identifiable)
        return fmt::format("Poisson's ratio of {} cannot be told from these images.{}", r.name,
                           as_sentence(r.ratio->reason));
    return fmt::format("Poisson's ratio of {}: {} ({} to {}). Verdict: {}.{}", r.name,
                       decimals(r.poisson_ratio, 2), decimals(r.ratio->interval[0], 2),
                       decimals(r.ratio->interval[1], 2), name_of(r.ratio->verdict),
                       as_sentence(r.ratio->reason));
}

std::string surfaces_sentence(const RecoveryResult& result) {
    double before = 0, after = 0;
    int count = 0;
    for (const SurfaceResult& s : result.surfaces) {
        if (!is_observed(s) || !std::isfinite(s.mean_distance_mm_before + s.mean_distance_mm_after))
            continue;
        before += s.mean_distance_mm_before;
        after += s.mean_distance_mm_after;
        ++count;
    }
    if (count == 0) return "";
    return fmt::format(
        "Mean distance to the target surfaces: {} mm after alignment, {} mm after "
        "the recovery ({} surface{}).",
        decimals(before / count, 2), decimals(after / count, 2), count, count == 1 ? "" : "s");
}

std::string seen_sentence(const RecoveryResult& result) {
    std::string parts;
    for (const SurfaceResult& s : result.surfaces) {
        if (s.target_kind == "labels") return "";
        parts += parts.empty() ? "" : "; ";
        parts += s.target_kind == "none"
                     ? fmt::format("{}: not given", s.name)
                     : fmt::format("{}: {} % ({})", s.name, decimals(100 * s.seen_share, 0),
                                   s.target_kind);
    }
    return parts.empty() ? "" : "Part of each surface that the target shows: " + parts + ".";
}

std::string landmark_sentence(const RecoveryResult& result) {
    if (result.landmarks.empty()) return "";
    double before = 0, after = 0, largest = 0;
    std::size_t outside = 0;
    for (const LandmarkResult& l : result.landmarks) {
        before += l.error_mm_before / static_cast<double>(result.landmarks.size());
        after += l.error_mm_after / static_cast<double>(result.landmarks.size());
        largest = std::max(largest, l.error_mm_after);
        outside += !l.is_inside;
    }
    return fmt::format(
        "{} landmark{}: mean error {} mm after rigid alignment, {} mm after the "
        "recovery, largest {} mm{}.",
        result.landmarks.size(), result.landmarks.size() == 1 ? "" : "s", decimals(before, 2),
        decimals(after, 2), decimals(largest, 2),
        outside ? fmt::format("; {} outside the displacement field", outside) : "");
}

std::string termination_sentence(const RecoveryResult& result) {
    const Termination& t = result.termination;
    return fmt::format("The search {} after {} iteration{} in {} s{}{}",
                       t.converged ? "converged" : "did NOT converge", t.iterations,
                       t.iterations == 1 ? "" : "s", decimals(total_seconds(result), 1),
                       t.reason.empty() ? "" : ": ", t.reason.empty() ? "." : t.reason + ".");
}

std::string contours_sentence(const RecoveryResult& result) {
    if (!result.contours) return "";
    const ContourError& contours = *result.contours;
    const char* whose = contours.images == 2 ? "of each image" : "of the reference";
    if (contours.is_given && contours.sd_mm == 0)
        return fmt::format("The contours {} were given to be exact.", whose);
    const std::string smoothly =
        fmt::format("smoothly along some {} mm", significant(contours.length_mm));
    const char* how = contours.slice_share == 0  ? ""
                      : contours.slice_share < 1 ? ", in part slice by slice"
                                                 : ", slice by slice";
    return fmt::format("The contours {} {} {} mm off, {}{}.", whose,
                       contours.is_given ? "were given to be" : "seem to be",
                       decimals(contours.sd_mm, 2), smoothly, how);
}

std::string law_sentence(const RecoveryResult& result) {
    return result.law.is_linear()
               ? "All tissue was taken to be linearly elastic."
               : fmt::format("All tissue was taken to be {}, at large deformation.",
                             result.law.name);
}

std::string linear_solvers_text(const RecoveryResult& result) {
    std::string text;
    for (const auto& [stage, solver] : result.linear_solvers)
        text += (text.empty() ? "" : "; ") + stage + ": " + solver_text(solver);
    return text;
}

std::vector<std::string> summary_sentences(const RecoveryResult& result) {
    std::vector<std::string> list;
    for (const RegionResult& r : result.regions)
        if (r.unknown) list.push_back(finding_sentence(result, r));
    for (const RegionResult& r : result.regions)
        if (r.ratio) list.push_back(ratio_sentence(r));
    if (const std::string text = surfaces_sentence(result); !text.empty()) list.push_back(text);
    if (const std::string text = seen_sentence(result); !text.empty()) list.push_back(text);
    if (const std::string text = landmark_sentence(result); !text.empty()) list.push_back(text);
    if (const std::string text = contours_sentence(result); !text.empty()) list.push_back(text);
    list.push_back(termination_sentence(result));
    return list;
}

}  // namespace palpate
