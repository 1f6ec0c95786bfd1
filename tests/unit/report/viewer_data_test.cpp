// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/viewer_data.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

using Json = nlohmann::json;

Vec3 vector_of(const Json& json) {
    return Vec3(json[0].get<double>(), json[1].get<double>(), json[2].get<double>());
}

/// Mean vertex of a target surface in voxels of the volumes, as the slice viewer finds them.
Vec3 centre_of_target_surface(const SurfaceView& view, const Json& data, int surface) {
    Vec3 mean = Vec3::Zero();
    const std::vector<Vec3>& vertices = view.surfaces[surface].outline->vertices;
    for (const Vec3& x : vertices) mean += x / double(vertices.size());
    const Json& volumes = data["volumes"];
    const Vec3 offset = mean - vector_of(volumes["origin_mm"]);
    Vec3 index;
    for (int a = 0; a < 3; ++a)
        index[a] = vector_of(volumes["axes"][a]).dot(offset) / vector_of(volumes["spacing_mm"])[a];
    return index;
}

Vec3 centre_of_voxels(const LabelVolumes& volumes, int organ) {
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (Index k = 0; k < volumes.size[2]; ++k)
        for (Index j = 0; j < volumes.size[1]; ++j)
            for (Index i = 0; i < volumes.size[0]; ++i)
                if (volumes.target[volumes.offset(i, j, k)] == organ) {
                    sum += Vec3(i, j, k);
                    ++count;
                }
    return sum / count;
}

TEST(ViewerData, SurfacesAreCutWhereTheVoxelsOfTheAlignedTargetLie) {
    constexpr int bladder = 2;          // round, and not cut by the image
    constexpr double tolerance_mm = 2;  // of mean vertices against mean voxels; alignment: 40 mm
    RecoveryResult result = synthetic_result();
    const RigidTransform further{Mat3::Identity(), Vec3(0, 0, 40)};
    auto& alignment = result.alignment.reference_to_target;
    alignment.translation = further.apply(alignment.translation);
    for (LabelImage* image :
         {&result.reference_labels, &result.target_labels_aligned, &result.warped_labels})
        image->grid.origin = further.apply(image->grid.origin);
    const LabelVolumes volumes = label_volumes(result);

    const Json data = Json::parse(viewer_data(result, volumes));

    const Vec3 off = centre_of_target_surface(recovery_view(result), data, bladder) -
                     centre_of_voxels(volumes, bladder + 1);
    EXPECT_LT(off.cwiseProduct(volumes.spacing).norm(), tolerance_mm);
}

TEST(RecoveryView, KnowsNoDistanceWhereTheTargetShowsNothingAndNoTractionWhereNothingDrives) {
    RecoveryResult result = synthetic_result();
    SurfaceResult& surface = result.surfaces.front();
    surface.seen.assign(surface.reference.vertices.size(), 1);
    surface.seen[3] = 0;

    const SurfaceView view = recovery_view(result);

    ASSERT_EQ(view.surfaces.size(), result.surfaces.size());
    EXPECT_TRUE(std::isnan(view.surfaces[0].values[0][0][3]));
    EXPECT_FALSE(std::isnan(view.surfaces[0].values[0][0][2]));
    for (std::size_t s = 0; s < view.surfaces.size(); ++s) {
        EXPECT_EQ(view.surfaces[s].values[2].empty(), result.surfaces[s].role != Role::driven);
        EXPECT_EQ(view.surfaces[s].is_shown, result.surfaces[s].role != Role::fixed);
    }
}

}  // namespace
}  // namespace palpate
