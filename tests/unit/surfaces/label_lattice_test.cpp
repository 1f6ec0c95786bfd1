// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/label_lattice.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "host/geometry/surfaces/surface_complex.hpp"

namespace palpate {
namespace {

constexpr Index side = 12;

RegionImage image_of(const std::vector<std::uint8_t>& labels) {
    RegionImage image;
    image.grid.size = {side, side, side};
    image.voxels = labels;
    return image;
}

LabelLattice lattice_of(const RegionImage& image) {
    return {image.grid.size, image.grid.spacing, image.voxels};
}

RegionImage random_image(int num_labels) {
    std::mt19937 random(3);
    std::vector<std::uint8_t> labels(side * side * side);
    for (auto& label : labels) label = std::uint8_t(1 + random() % num_labels);
    return image_of(labels);
}

// Edges of a region's boundary that do not have exactly two of its faces.
int open_or_crowded_edges(const SurfaceComplex& complex, std::uint8_t region) {
    std::map<std::pair<Index, Index>, int> faces;
    for (const auto& face : complex.faces) {
        if (face.regions[0] != region && face.regions[1] != region) continue;
        for (int i = 0; i < 3; ++i) {
            const Index u = face.v[i], v = face.v[(i + 1) % 3];
            ++faces[{std::min(u, v), std::max(u, v)}];
        }
    }
    int bad = 0;
    for (const auto& [edge, count] : faces) bad += count != 2;
    return bad;
}

TEST(LabelLattice, RandomLabelsHaveNonManifoldBoundariesUntilTheyAreRepaired) {
    const RegionImage image = random_image(3);
    const LabelField field(image, 4);
    LabelLattice lattice = lattice_of(image);
    const int before = open_or_crowded_edges(boundary_of(lattice), 2);

    make_well_composed(lattice, image.grid, field);

    EXPECT_GT(before, 0);
    for (std::uint8_t region : {1, 2, 3})
        EXPECT_EQ(open_or_crowded_edges(boundary_of(lattice), region), 0) << int(region);
}

TEST(LabelLattice, TwoCellsThatMeetInACornerAreJoinedOrParted) {
    std::vector<std::uint8_t> labels(side * side * side, 1);
    LabelLattice lattice = lattice_of(image_of(labels));
    for (Index i = 2; i < 6; ++i)
        for (Index j = 2; j < 6; ++j)
            for (Index k = 2; k < 6; ++k) {
                lattice.labels[lattice.offset(i, j, k)] = 2;
                lattice.labels[lattice.offset(i + 4, j + 4, k + 4)] = 2;
            }
    const RegionImage image = image_of(lattice.labels);
    const LabelField field(image, 3);
    const auto around_one_vertex = [&] {
        const SurfaceComplex complex = boundary_of(lattice);
        std::size_t most = 0;
        for (const auto& faces : complex.faces_of) most = std::max(most, faces.size());
        return most;
    };
    EXPECT_GE(around_one_vertex(), 9u);

    make_well_composed(lattice, image.grid, field);

    const SurfaceComplex complex = boundary_of(lattice);
    EXPECT_EQ(open_or_crowded_edges(complex, 2), 0);
    EXPECT_LT(std::count(lattice.labels.begin(), lattice.labels.end(), 2), 2 * 64 + 4);
    EXPECT_GT(std::count(lattice.labels.begin(), lattice.labels.end(), 2), 2 * 64 - 4);
}

TEST(LabelLattice, SheetsOneCellThinGoAndSheetsTwoCellsThickStay) {
    std::vector<std::uint8_t> labels(side * side * side, 1);
    for (std::size_t cell = 0; cell < labels.size(); ++cell) {
        const std::size_t i = cell % side;
        if (i == 3) labels[cell] = 2;
        if (i == 7 || i == 8) labels[cell] = 3;
    }
    const RegionImage image = image_of(labels);
    const LabelField field(image, 4);
    LabelLattice lattice = lattice_of(image);

    remove_thin_parts(lattice, image.grid, field);

    EXPECT_EQ(std::count(lattice.labels.begin(), lattice.labels.end(), 2), 0);
    EXPECT_EQ(std::count(lattice.labels.begin(), lattice.labels.end(), 3), 2 * side * side);
}

TEST(LabelLattice, SpecksGoToTheirSurroundingsButTheOnlyPieceOfAnOrganStays) {
    std::vector<std::uint8_t> labels(side * side * side, 1);
    LabelLattice lattice = lattice_of(image_of(labels));
    lattice.labels[lattice.offset(2, 2, 2)] = 2;  // the organ
    lattice.labels[lattice.offset(3, 2, 2)] = 2;
    lattice.labels[lattice.offset(9, 9, 9)] = 2;  // its speck

    remove_specks(lattice, 5);

    EXPECT_EQ(lattice.at(2, 2, 2), 2);
    EXPECT_EQ(lattice.at(9, 9, 9), 1);
}

TEST(LabelLattice, SamplingCoversTheBoxWithCellsOfAboutTheWantedSpacing) {
    RegionImage image;
    image.grid.size = {40, 40, 10};
    image.grid.spacing = {0.5, 0.6, 3.0};
    image.voxels.assign(image.grid.num_voxels(), 1);
    for (Index k = 0; k < 5; ++k)
        for (Index j = 0; j < 40; ++j)
            for (Index i = 0; i < 40; ++i) image.at(i, j, k) = 2;
    const LabelField field(image, 3);

    const LabelLattice lattice = sample_labels(image, field, 1.5);

    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_DOUBLE_EQ(lattice.size[axis] * lattice.spacing[axis],
                         image.grid.size[axis] * image.grid.spacing[axis]);
        EXPECT_NEAR(lattice.spacing[axis], 1.5, 0.1);
    }
    EXPECT_EQ(lattice.at(5, 5, 9), 2);
    EXPECT_EQ(lattice.at(5, 5, 10), 1);
    EXPECT_EQ(lattice.at(5, 5, 20), beyond_box);
}

}  // namespace
}  // namespace palpate
