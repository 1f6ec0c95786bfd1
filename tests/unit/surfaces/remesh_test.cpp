// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/remesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace palpate {
namespace {

constexpr double radius_mm = 9, edge_mm = 3;
const Vec3 centre = Vec3::Constant(15);  // in the frame of the image: its corner is at 0

/// A ball (region 2) in a box of background, 30 voxels of 1 mm wide.
RegionImage ball_image() {
    RegionImage image;
    image.grid.size = {30, 30, 30};
    image.grid.origin = Vec3::Constant(0.5);
    image.voxels.assign(image.grid.num_voxels(), background_region);
    for (Index k = 0; k < 30; ++k)
        for (Index j = 0; j < 30; ++j)
            for (Index i = 0; i < 30; ++i)
                if ((image.grid.to_point(Vec3(i, j, k)) - centre).norm() < radius_mm)
                    image.at(i, j, k) = first_organ_region;
    return image;
}

/// The staircase between ball and box, and what it is to follow.
struct Ball {
    RegionImage image = ball_image();
    LabelField field{image, 3};
    LabelLattice lattice = sample_labels(image, field, 0.75 * edge_mm);
    SurfaceComplex complex = boundary_of(lattice);
    Interfaces interfaces{field, image.grid};

    void relax() { relax_staircase(complex, interfaces, 0.5 * lattice.spacing, 6); }
    void remesh_to(double length_mm) {
        remesh(
            complex, interfaces, [&](const SurfaceComplex&, Index) { return length_mm; }, 6);
    }
    static bool is_of_ball(const SurfaceComplex::Face& face) {
        return face.is_alive() &&
               (face.regions[0] == first_organ_region || face.regions[1] == first_organ_region);
    }
    std::vector<SurfaceComplex::Face> faces() const {
        std::vector<SurfaceComplex::Face> found;
        std::copy_if(complex.faces.begin(), complex.faces.end(), std::back_inserter(found),
                     is_of_ball);
        return found;
    }
    /// {edge: number of the ball's faces there}
    std::map<std::array<Index, 2>, int> edges() const {
        std::map<std::array<Index, 2>, int> count;
        for (const auto& face : faces())
            for (int c = 0; c < 3; ++c) {
                const Index a = face.v[c], b = face.v[(c + 1) % 3];
                ++count[{std::min(a, b), std::max(a, b)}];
            }
        return count;
    }
    std::vector<Index> vertices() const {
        std::vector<Index> all;
        for (const auto& face : faces()) all.insert(all.end(), face.v.begin(), face.v.end());
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    }
    /// Largest distance of a vertex from the sphere, mm.
    double farthest() const {
        double worst = 0;
        for (const Index v : vertices())
            worst = std::max(worst, std::abs((complex.points[v] - centre).norm() - radius_mm));
        return worst;
    }
    /// Root mean square of that distance, mm.
    double rms_distance() const {
        double sum = 0;
        for (const Index v : vertices())
            sum += std::pow((complex.points[v] - centre).norm() - radius_mm, 2);
        return std::sqrt(sum / double(vertices().size()));
    }
    double volume() const {  // behind < in front: normals go from regions[0] to regions[1]
        double sum = 0;
        for (const auto& face : faces()) {
            const auto& p = complex.points;
            const double part =
                (p[face.v[0]] - centre).dot((p[face.v[1]] - centre).cross(p[face.v[2]] - centre));
            sum += std::abs(part) / 6;
        }
        return sum;
    }
};

TEST(Remesh, RelaxingTakesTheStaircaseToTheSphere) {
    Ball ball;
    const double before = ball.farthest();

    ball.relax();

    EXPECT_GT(before, 0.5);
    EXPECT_LT(ball.farthest(), 0.2 * before);
}

TEST(Remesh, KeepsAClosedSphereAndItsVolume) {
    Ball ball;
    ball.relax();

    ball.remesh_to(edge_mm);

    for (const auto& [edge, faces] : ball.edges()) EXPECT_EQ(faces, 2);
    const auto euler =
        Index(ball.vertices().size()) - Index(ball.edges().size()) + Index(ball.faces().size());
    EXPECT_EQ(euler, 2);
    EXPECT_LT(ball.farthest(), 0.5);  // labels tell no more than half a voxel
    EXPECT_LT(ball.rms_distance(), 0.15);
    // Chords of length l cut l^2 / (8 r) off at most: 4 % of the volume for 3 mm on 9 mm.
    const double full = 4.0 / 3.0 * M_PI * std::pow(radius_mm, 3);
    EXPECT_NEAR(ball.volume() / full, 0.97, 0.04);
}

TEST(Remesh, EdgesHaveTheLengthThatIsAskedFor) {
    for (const double wanted : {2.0, 4.0}) {
        Ball ball;
        ball.relax();

        ball.remesh_to(wanted);

        double sum = 0;
        Index outside = 0;
        const auto edges = ball.edges();
        for (const auto& [edge, faces] : edges) {
            const double length =
                (ball.complex.points[edge[0]] - ball.complex.points[edge[1]]).norm();
            sum += length;
            outside += length < 0.6 * wanted || length > 1.5 * wanted;
        }
        EXPECT_NEAR(sum / edges.size(), wanted, 0.2 * wanted);
        EXPECT_LT(outside, 0.03 * edges.size()) << "of " << edges.size();
    }
}

TEST(Remesh, TrianglesAreWellShaped) {
    Ball ball;
    ball.relax();
    ball.remesh_to(edge_mm);

    double sharpest = -1, mean = 0;
    for (const auto& face : ball.faces()) {
        const auto& p = ball.complex.points;
        const double cosine = largest_cosine(p[face.v[0]], p[face.v[1]], p[face.v[2]]);
        sharpest = std::max(sharpest, cosine);
        mean += std::acos(cosine) * 180 / M_PI / double(ball.faces().size());
    }
    EXPECT_LT(sharpest, std::cos(20 * M_PI / 180));
    EXPECT_GT(mean, 45) << "smallest angles, degrees; 60 of equal sides";
}

TEST(Remesh, BoxStaysABox) {
    Ball ball;
    ball.relax();
    ball.remesh_to(edge_mm);
    polish(ball.complex, ball.interfaces, [](const SurfaceComplex&, Index) { return edge_mm; });

    Vec3 low = Vec3::Constant(1e9), high = -low;
    for (const auto& face : ball.complex.faces) {
        if (face.plane < 0 || !face.is_alive()) continue;
        for (const Index v : face.v) {
            const Vec3& x = ball.complex.points[v];
            EXPECT_NEAR(x[face.plane / 2], face.plane % 2 ? 30.0 : 0.0, 1e-9);
            low = low.cwiseMin(x);
            high = high.cwiseMax(x);
        }
    }
    EXPECT_LT((low - Vec3(0, 0, 0)).norm(), 1e-9);
    EXPECT_LT((high - Vec3(30, 30, 30)).norm(), 1e-9);
}

TEST(Remesh, EveningOutPutsAVertexAmongItsNeighbours) {
    Ball ball;
    ball.relax();
    const Index vertex = ball.vertices().front();
    Vec3 sum = Vec3::Zero();
    std::vector<Index> around;
    for (const Index f : ball.complex.faces_of[vertex])
        for (const Index v : ball.complex.faces[f].v)
            if (v != vertex && std::find(around.begin(), around.end(), v) == around.end())
                around.push_back(v);
    for (const Index v : around) sum += ball.complex.points[v];

    even_out(ball.complex, vertex);

    EXPECT_LT((ball.complex.points[vertex] - sum / double(around.size())).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate
