// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/extract.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "host/geometry/surfaces/intersections.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/imaging/voxelised.hpp"

namespace palpate {
namespace {

using testing::grid_around;
using testing::voxelised;

struct Extracted {
    RegionImage image;
    RegionSurface surface;
    SurfaceSummary summary;
};

Extracted extract(const RegionImage& image, const SurfaceOptions& options = {}) {
    Extracted result{image, {}, {}};
    const Index num_regions = 1 + *std::max_element(image.voxels.begin(), image.voxels.end());
    const LabelField field(image, num_regions);
    result.surface = extract_surfaces(image, field, options, &result.summary);
    return result;
}

Mat3 tilted() { return testing::oblique_direction(); }

double distance(const Vec3& a, const Vec3& b) { return (a - b).norm(); }

RegionImage sphere(const Mat3& direction = Mat3::Identity()) {
    return voxelised(grid_around({5, -8, 20}, 50, {1, 1, 1}, direction), [](const Vec3& x) {
        return distance(x, {5, -8, 20}) < 15 ? 2 : 1;
    });
}

// Two halves of a sphere, one in a shell: four regions, all touching.
RegionImage touching() {
    return voxelised(grid_around({0, 0, 0}, 60, {0.8, 0.8, 2}, tilted()), [](const Vec3& x) {
        const double r = x.norm();
        if (r > 22) return 1;
        if (r > 15) return 4;
        return x[0] < 2 ? 2 : 3;
    });
}

RegionImage crescent() {
    return voxelised(grid_around({0, 0, 0}, 56, {1, 1, 1}), [](const Vec3& x) {
        if (x.norm() > 20) return 1;
        return distance(x, {0, 6, 0}) < 20 ? 3 : 2;
    });
}

RegionImage barely_touching() {
    return voxelised(grid_around({0, 0, 0}, 70, {1, 1, 1}), [](const Vec3& x) {
        if (distance(x, {-15, 0, 0}) < 15.2) return 2;
        return distance(x, {15, 0, 0}) < 15.2 ? 3 : 1;
    });
}

// A ball cut by the low end of the third axis; region 0 fills the high end.
RegionImage cut_by_the_box(const Mat3& direction) {
    const ImageGrid grid = grid_around({0, 0, 0}, 50, {1, 1, 2}, direction);
    const Vec3 centre = grid.to_point({24.5, 24.5, 1});
    return voxelised(grid, [=](const Vec3& x) {
        if (distance(x, centre) < 14) return 2;
        return grid.to_index(x)[2] > 18 ? 0 : 1;
    });
}

// ---- what must hold for every surface ----

void expect_closed_manifolds(const Extracted& e) {
    for (const auto& region : e.summary.regions) {
        const Surface s = surface_of_region(e.surface, region.region);
        std::map<std::pair<Index, Index>, int> directed;
        for (const Triangle& t : s.triangles)
            for (int i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
        int bad = 0;
        for (const auto& [edge, count] : directed)
            bad += count != 1 || !directed.contains({edge.second, edge.first});
        EXPECT_EQ(bad, 0) << "region " << region.region;
    }
}

// The faces round every vertex of a region form one fan.
void expect_no_pinched_vertices(const Extracted& e) {
    for (const auto& region : e.summary.regions) {
        const Surface s = surface_of_region(e.surface, region.region);
        std::vector<std::map<Index, Index>> next(s.vertices.size());
        for (const Triangle& t : s.triangles)
            for (int i = 0; i < 3; ++i) next[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
        for (const auto& link : next) {
            std::size_t length = 0;
            Index at = link.begin()->first;
            do at = link.at(at), ++length;
            while (at != link.begin()->first && length <= link.size());
            EXPECT_EQ(length, link.size()) << "region " << region.region;
        }
    }
}

void expect_volumes_kept(const Extracted& e, double tolerance) {
    std::map<Index, double> voxels;
    for (std::uint8_t region : e.image.voxels) voxels[region] += e.image.grid.voxel_volume();
    voxels.erase(outside_region);
    ASSERT_EQ(e.summary.regions.size(), voxels.size());
    for (const auto& region : e.summary.regions) {
        const double enclosed = enclosed_volume(surface_of_region(e.surface, region.region));
        EXPECT_NEAR(region.voxel_volume_mm3, voxels[region.region], 1e-6 * voxels[region.region]);
        EXPECT_NEAR(enclosed, voxels[region.region], tolerance * voxels[region.region])
            << "region " << region.region;
        EXPECT_NEAR(region.surface_volume_mm3, enclosed, 1e-6 * enclosed);
    }
}

void expect_box_covered_and_flat(const Extracted& e) {
    const ImageGrid& grid = e.image.grid;
    double area = 0, expected = 0;
    for (Index t = 0; t < e.surface.num_triangles(); ++t) {
        std::array<Vec3, 3> at;  // voxel indices
        for (int i = 0; i < 3; ++i) {
            at[i] = grid.to_index(e.surface.vertices[e.surface.triangles[t][i]]);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GT(at[i][axis], -0.5 - 1e-9);
                EXPECT_LT(at[i][axis], grid.size[axis] - 0.5 + 1e-9);
            }
        }
        bool is_flat = false;
        for (int axis = 0; axis < 3; ++axis)
            for (const double plane : {-0.5, grid.size[axis] - 0.5}) {
                const auto is_there = [&](const Vec3& p) {
                    return std::abs(p[axis] - plane) < 1e-9;
                };
                is_flat |= std::all_of(at.begin(), at.end(), is_there);
            }
        EXPECT_EQ(bool(e.surface.on_image_border[t]), is_flat);
        if (!is_flat) continue;
        EXPECT_EQ(e.surface.regions[t][1], outside_region);
        const Vec3 &a = e.surface.vertices[e.surface.triangles[t][0]],
                   &b = e.surface.vertices[e.surface.triangles[t][1]],
                   &c = e.surface.vertices[e.surface.triangles[t][2]];
        const Vec3 normal = (b - a).cross(c - a);
        const Vec3 middle = grid.to_point(
            {0.5 * (grid.size[0] - 1), 0.5 * (grid.size[1] - 1), 0.5 * (grid.size[2] - 1)});
        EXPECT_GT(normal.dot(a - middle), 0);  // outward
        area += normal.norm() / 2;
    }
    for (int axis = 0; axis < 3; ++axis)
        expected += 2 * grid.size[axis] * grid.spacing[axis] * grid.size[(axis + 1) % 3] *
                    grid.spacing[(axis + 1) % 3];
    const bool has_outside = std::count(e.image.voxels.begin(), e.image.voxels.end(), 0) > 0;
    if (!has_outside) {
        EXPECT_NEAR(area, expected, 1e-6 * expected);
    }
}

struct Shape {
    double min_angle_deg, share_below_20_deg, median_organ_edge_mm, sharpest_wedge_deg;
};

Shape shape_of(const RegionSurface& s) {
    constexpr double degrees = 57.29577951308232;
    std::vector<double> angles, organ_edges;
    std::map<std::pair<Index, Index>, std::vector<Vec3>> flanks;
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            const Index u = s.triangles[t][i], v = s.triangles[t][(i + 1) % 3];
            const Vec3& a = s.vertices[u];
            const Vec3 ab = s.vertices[v] - a, ac = s.vertices[s.triangles[t][(i + 2) % 3]] - a;
            angles.push_back(std::acos(ab.dot(ac) / ab.norm() / ac.norm()) * degrees);
            const Vec3 along = ab.normalized();
            flanks[{std::min(u, v), std::max(u, v)}].push_back(
                (ac - along * along.dot(ac)).normalized());
            if (std::max(s.regions[t][0], s.regions[t][1]) >= first_organ_region)
                organ_edges.push_back(ab.norm());
        }
    double wedge = 180;
    for (const auto& [edge, sides] : flanks)
        for (std::size_t i = 0; i < sides.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                wedge = std::min(wedge,
                                 std::acos(std::clamp(sides[i].dot(sides[j]), -1., 1.)) * degrees);
    std::nth_element(organ_edges.begin(), organ_edges.begin() + organ_edges.size() / 2,
                     organ_edges.end());
    const auto narrow =
        std::count_if(angles.begin(), angles.end(), [](double a) { return a < 20; });
    return {*std::min_element(angles.begin(), angles.end()), double(narrow) / double(angles.size()),
            organ_edges[organ_edges.size() / 2], wedge};
}

void expect_well_shaped(const Extracted& e, double edge_length_mm) {
    const Shape shape = shape_of(e.surface);
    EXPECT_GT(shape.min_angle_deg, 10);
    EXPECT_LT(shape.share_below_20_deg, 0.002);
    EXPECT_GT(shape.sharpest_wedge_deg, 15);
    EXPECT_NEAR(shape.median_organ_edge_mm, edge_length_mm, 0.1 * edge_length_mm);
}

struct Scene {
    const char* name;
    RegionImage (*make)();
};

class EverySurface : public ::testing::TestWithParam<Scene> {};

TEST_P(EverySurface, IsClosedConformingFreeOfCrossingsAndKeepsVolumes) {
    const Extracted e = extract(GetParam().make());

    expect_closed_manifolds(e);
    expect_no_pinched_vertices(e);
    expect_volumes_kept(e, 0.005);
    expect_box_covered_and_flat(e);
    expect_well_shaped(e, SurfaceOptions{}.edge_length_mm);
    EXPECT_TRUE(find_intersections(e.surface.vertices, e.surface.triangles).empty());
}

RegionImage upright_sphere() { return sphere(); }
RegionImage tilted_sphere() { return sphere(tilted()); }
RegionImage mirrored_sphere() { return sphere(testing::left_handed_direction()); }
RegionImage cut_upright() { return cut_by_the_box(Mat3::Identity()); }
RegionImage cut_mirrored() { return cut_by_the_box(testing::left_handed_direction()); }

INSTANTIATE_TEST_SUITE_P(
    Surfaces, EverySurface,
    ::testing::Values(Scene{"sphere", upright_sphere}, Scene{"tilted", tilted_sphere},
                      Scene{"mirrored", mirrored_sphere}, Scene{"touching", touching},
                      Scene{"crescent", crescent}, Scene{"barely_touching", barely_touching},
                      Scene{"cut", cut_upright}, Scene{"cut_mirrored", cut_mirrored}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ExtractSurfaces, ASphereIsRoundAtAFractionOfAVoxel) {
    const Extracted e = extract(sphere(tilted()));

    const Surface s = surface_of_region(e.surface, 2);
    double sum = 0, largest = 0;
    for (const Vec3& x : s.vertices) {
        const double off = distance(x, {5, -8, 20}) - 15;
        sum += off * off;
        largest = std::max(largest, std::abs(off));
    }

    // 1 mm voxels; the offset of 0.06 mm that makes up for the chords is included
    EXPECT_LT(std::sqrt(sum / double(s.vertices.size())), 0.25);
    EXPECT_LT(largest, 0.5);
    EXPECT_FALSE(e.summary.regions[1].cut_by_image);
}

TEST(ExtractSurfaces, TouchingRegionsShareTheirTriangles) {
    const Extracted e = extract(touching());

    std::set<std::array<Index, 2>> interfaces(e.surface.regions.begin(), e.surface.regions.end());
    EXPECT_EQ(interfaces, (std::set<std::array<Index, 2>>{{1, 0}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}));
    double area = 0;
    for (std::size_t t = 0; t < e.surface.triangles.size(); ++t) {
        if (e.surface.regions[t] != std::array<Index, 2>{2, 3}) continue;
        const auto& [a, b, c] = e.surface.triangles[t];
        const auto& v = e.surface.vertices;
        const Vec3 normal = (v[b] - v[a]).cross(v[c] - v[a]);
        EXPECT_GT(normal[0], 0.8 * normal.norm());  // from region 2 to region 3
        area += normal.norm() / 2;
    }
    const double disk = 3.14159265 * (15 * 15 - 2 * 2);
    EXPECT_NEAR(area, disk, 0.03 * disk);
}

TEST(ExtractSurfaces, ACutOrganGetsACapThatIsMarked) {
    const Extracted e = extract(cut_by_the_box(tilted()));

    const auto& organ = e.summary.regions.back();
    ASSERT_EQ(organ.region, 2);
    EXPECT_TRUE(organ.cut_by_image);
    double cap = 0;
    for (std::size_t t = 0; t < e.surface.triangles.size(); ++t) {
        if (e.surface.regions[t][0] != 2 || !e.surface.on_image_border[t]) continue;
        const auto& [a, b, c] = e.surface.triangles[t];
        const auto& v = e.surface.vertices;
        cap += (v[b] - v[a]).cross(v[c] - v[a]).norm() / 2;
    }
    const double disk = 3.14159265 * (14 * 14 - 3 * 3);  // the box ends 3 mm from the centre
    EXPECT_NEAR(cap, disk, 0.06 * disk);  // the field runs straight on through the last half voxel
}

TEST(ExtractSurfaces, TheBoxIsCoarseFarFromOrgans) {
    RegionImage image = voxelised(grid_around({0, 0, 0}, 120, {2, 2, 2}),
                                  [](const Vec3& x) { return x.norm() < 12 ? 2 : 1; });

    const Extracted e = extract(image);

    std::vector<double> lengths;
    for (std::size_t t = 0; t < e.surface.triangles.size(); ++t) {
        if (!e.surface.on_image_border[t]) continue;
        const auto& [a, b, c] = e.surface.triangles[t];
        lengths.push_back(distance(e.surface.vertices[a], e.surface.vertices[b]));
    }
    std::nth_element(lengths.begin(), lengths.begin() + lengths.size() / 2, lengths.end());
    EXPECT_NEAR(lengths[lengths.size() / 2], 12, 2);
}

TEST(ExtractSurfaces, AThinCrescentKeepsOnePieceWithoutHoles) {
    const Extracted e = extract(crescent());

    const Surface s = surface_of_region(e.surface, 2);
    const auto euler = Index(s.vertices.size()) - Index(s.triangles.size()) / 2;
    EXPECT_EQ(euler, 2);
}

TEST(ExtractSurfaces, AnOrganTooSmallForTheEdgeLengthIsRefused) {
    const RegionImage image = voxelised(grid_around({0, 0, 0}, 30, {1, 1, 1}),
                                        [](const Vec3& x) { return x.norm() < 2.5 ? 2 : 1; });

    try {
        extract(image);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("egion 2"), std::string::npos);
    }
    SurfaceOptions fine;
    fine.edge_length_mm = 1;
    EXPECT_NO_THROW(extract(image, fine));
}

TEST(ExtractSurfacesFinely, ShortensTheEdgesForASmallOrganAndSaysWhy) {
    const RegionImage image = voxelised(grid_around({0, 0, 0}, 30, {1, 1, 1}),
                                        [](const Vec3& x) { return x.norm() < 2.5 ? 2 : 1; });
    const LabelField field(image, 3);
    SurfaceOptions options;
    std::string reason;
    const RegionSurface surface = extract_surfaces_finely(image, field, options, &reason);
    EXPECT_GT(surface.num_triangles(), 0);
    EXPECT_LT(options.edge_length_mm, SurfaceOptions{}.edge_length_mm);
    EXPECT_GE(options.edge_length_mm, 1) << "no less than a voxel";
    EXPECT_NE(reason.find("egion 2"), std::string::npos) << reason;
}

TEST(ExtractSurfacesFinely, ChangesNothingWhereTheFirstEdgesDo) {
    const RegionImage image = sphere();
    SurfaceOptions options;
    std::string reason;
    const RegionSurface surface =
        extract_surfaces_finely(image, LabelField(image, 3), options, &reason);
    EXPECT_EQ(surface.triangles, extract(image).surface.triangles);
    EXPECT_EQ(options.edge_length_mm, SurfaceOptions{}.edge_length_mm);
    EXPECT_EQ(options.volume_tolerance, SurfaceOptions{}.volume_tolerance);
    EXPECT_EQ(reason, "");
}

TEST(ExtractSurfacesFinely, ThrowsTheFirstErrorWhereNothingHelps) {
    const RegionImage image = voxelised(grid_around({0, 0, 0}, 30, {1, 1, 1}),
                                        [](const Vec3& x) { return x.norm() < 0.9 ? 2 : 1; });
    SurfaceOptions options;
    try {
        extract_surfaces_finely(image, LabelField(image, 3), options);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("edge length of 3 mm"), std::string::npos)
            << error.what();
    }
}

TEST(ExtractSurfaces, AnOrganThinnerThanTheEdgesIsRefusedWithItsName) {
    const RegionImage image = voxelised(grid_around({0, 0, 0}, 40, {1, 1, 1}), [](const Vec3& x) {
        return std::abs(x[2] - 0.5) < 0.4 && x.norm() < 15 ? 2 : 1;
    });

    try {
        extract(image);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("egion 2"), std::string::npos);
    }
}

TEST(ExtractSurfaces, TheSameInputGivesTheSameSurface) {
    const Extracted first = extract(touching()), second = extract(touching());

    EXPECT_EQ(first.surface.triangles, second.surface.triangles);
    EXPECT_EQ(first.surface.vertices, second.surface.vertices);
}

}  // namespace
}  // namespace palpate
