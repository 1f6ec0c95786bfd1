// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "host/geometry/surfaces/extract.hpp"
#include "host/geometry/surfaces/intersections.hpp"
#include "host/io/volume_files.hpp"

namespace palpate {
namespace {

struct RealCase {
    const char* name;
    const char* file;
    std::map<int, Index> region_of;  ///< label -> region
    Index other;                     ///< region of all other labels
    std::vector<Index> cut;          ///< organs that the field of view cuts
    double edge_length_mm = 3;
};

std::filesystem::path data_folder() {
    const char* folder = std::getenv("PALPATE_DATA");
    return folder ? folder : "";
}

RegionImage regions_of(const LabelImage& labels, const RealCase& real) {
    RegionImage image{labels.grid, {}};
    image.voxels.reserve(labels.voxels.size());
    for (std::uint16_t label : labels.voxels) {
        const auto found = real.region_of.find(label);
        image.voxels.push_back(
            std::uint8_t(found == real.region_of.end() ? real.other : found->second));
    }
    return image;
}

// Edges of a closed surface that do not have exactly one face on either side.
int bad_edges(const Surface& surface) {
    std::map<std::pair<Index, Index>, int> directed;
    for (const Triangle& t : surface.triangles)
        for (int i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
    return int(std::count_if(directed.begin(), directed.end(), [&](const auto& edge) {
        return edge.second != 1 || !directed.contains({edge.first.second, edge.first.first});
    }));
}

class RealSurface : public ::testing::TestWithParam<RealCase> {};

TEST_P(RealSurface, KeepsVolumesIsClosedAndFreeOfCrossings) {
    const auto path = data_folder() / GetParam().file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "PALPATE_DATA has no " << GetParam().file;
    const RegionImage image = regions_of(read_label_image(path), GetParam());
    const Index num_regions = 1 + *std::max_element(image.voxels.begin(), image.voxels.end());
    const LabelField field(image, num_regions);

    SurfaceOptions options;
    options.edge_length_mm = GetParam().edge_length_mm;
    SurfaceSummary summary;
    const RegionSurface surface = extract_surfaces(image, field, options, &summary);

    EXPECT_EQ(find_intersections(surface.vertices, surface.triangles).size(), 0u);
    for (const auto& region : summary.regions) {
        const Surface closed = surface_of_region(surface, region.region);
        EXPECT_EQ(bad_edges(closed), 0) << "region " << region.region;
        const auto voxels =
            std::count(image.voxels.begin(), image.voxels.end(), std::uint8_t(region.region));
        const double volume = double(voxels) * image.grid.voxel_volume();
        EXPECT_NEAR(enclosed_volume(closed), volume, 0.02 * volume) << "region " << region.region;
        if (region.region < first_organ_region) continue;
        const auto& cut = GetParam().cut;
        EXPECT_EQ(region.cut_by_image,
                  std::find(cut.begin(), cut.end(), region.region) != cut.end())
            << "region " << region.region;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Data, RealSurface,
    ::testing::Values(RealCase{"pelvis_mr_reference",
                               "pelvis_mr_pair_prostatex0001/reference_labels.nii.gz",
                               {{1, 2}, {2, 3}, {3, 4}, {4, 5}},
                               1,
                               {2, 5}},
                      RealCase{"pelvis_mr_deformed",
                               "pelvis_mr_pair_prostatex0001/deformed_labels.nii.gz",
                               {{1, 2}, {2, 3}, {3, 4}, {4, 5}},
                               1,
                               {2, 5}},
                      RealCase{"abdomen_ct",
                               "abdomen_ct_totalsegmentator_example/labels.nii.gz",
                               {{1, 2}, {2, 3}, {3, 4}, {5, 5}, {20, 6}},
                               1,
                               {2, 3, 4, 5, 6},
                               6},
                      RealCase{"lung_without_background",
                               "lung_ct_pair_elastix/baseline_lung_mask.mha",
                               {{1, 2}},
                               0,
                               {2},
                               8}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace palpate
