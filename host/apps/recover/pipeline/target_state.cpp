// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/target_state.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "host/apps/recover/pipeline/volumes.hpp"
#include "host/geometry/meshing/rasterise.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

AlignMethod method_for(const RecoverOptions& options) {
    if (!options.initial_transform.empty()) return AlignMethod::transform;
    if (options.align != AlignMethod::automatic) return options.align;
    const auto& organs = options.settings.organs;
    return std::any_of(organs.begin(), organs.end(), is_fixed) ? AlignMethod::fixed
                                                               : AlignMethod::centroid;
}

AlignmentResult align(const RecoverOptions& options, const ReferenceState& reference,
                      const LabelledState& target) {
    switch (method_for(options)) {
        case AlignMethod::transform:
            return {"transform", read_rigid_transform(options.initial_transform), 0};
        case AlignMethod::none:
            return {"none", {}, 0};
        case AlignMethod::fixed:
            return align_surfaces(reference.fixed_points,
                                  maps_of_fixed(target.field, options.settings, target_margin_mm),
                                  {});
        default:
            return {"centroid",
                    align_centroids(reference.state.regions, target.regions, options.settings), 0};
    }
}

void check_overlap(const LabelledState& reference, const LabelledState& target,
                   const AlignmentResult& alignment, const Settings& settings) {
    const auto carried =
        carry_regions(reference.field, alignment.reference_to_target, target.regions.grid);
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        const Index region = first_organ_region + static_cast<Index>(k);
        if (!is_matched(settings.organs[k]) || dice(carried, target.regions, region) > 0) continue;
        throw Error(ErrorCode::input_unusable,
                    fmt::format("organ '{}' does not overlap between reference and target after "
                                "alignment ('{}'); check that both show the same patient in one "
                                "frame, or give --initial-transform or --align centroid",
                                settings.organs[k].name, alignment.method));
    }
}

}  // namespace

TargetState align_target(LabelledState target, const ReferenceState& reference,
                         const RecoverOptions& options, const ProgressSink& progress) {
    AlignmentResult alignment = align(options, reference, target);
    check_overlap(reference.state, target, alignment, options.settings);
    const Vec3& shift = alignment.reference_to_target.translation;
    report_progress(progress, "aligning", 1,
                    fmt::format("{}: translation ({:.2f}, {:.2f}, {:.2f}) mm", alignment.method,
                                shift[0], shift[1], shift[2]));
    std::string name = target.name;
    return {std::move(name), std::move(alignment), std::move(target), {}, 0};
}

}  // namespace palpate
