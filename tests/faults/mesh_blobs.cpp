// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Meshes random label volumes as a recovery does, and prints a line for each:
//   <seed> meshed <mesher> <inverted> <smallest dihedral angle> <largest error of a volume>
//   <seconds> <seed> failed <code> <reason>
// mesh_blobs FIRST LAST
#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <random>

#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/meshing/mesh_checks.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "host/geometry/surfaces/extract.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

struct Bump {
    Vec3 centre;  // of the box, 0 to 1
    double width, height;
};

/// Organs of several bumps each, which touch, cross the border, hold holes and leave islands; every
/// third has rough borders.
RegionImage random_blobs(unsigned seed) {
    std::mt19937 draw(seed);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(draw);
    };
    RegionImage image;
    for (int a = 0; a < 3; ++a) {
        image.grid.size[a] = static_cast<Index>(uniform(24, 48));
        image.grid.spacing[a] = uniform(1, a == 2 ? 4 : 2);
    }
    const int num_organs = 1 + static_cast<int>(seed % 4);
    std::vector<std::vector<Bump>> organs(num_organs);
    for (auto& bumps : organs) {
        const Vec3 middle(uniform(0.25, 0.75), uniform(0.25, 0.75), uniform(0.25, 0.75));
        const int count = static_cast<int>(uniform(1, 6));
        for (int k = 0; k < count; ++k)
            bumps.push_back({middle + Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * 0.2,
                             uniform(0.06, 0.18), k > 0 && uniform(0, 1) < 0.25 ? -0.8 : 1.0});
    }
    const double roughness = seed % 3 == 0 ? 0.15 : 0;
    const auto& size = image.grid.size;
    for (Index k = 0; k < size[2]; ++k)
        for (Index j = 0; j < size[1]; ++j)
            for (Index i = 0; i < size[0]; ++i) {
                const Vec3 at((i + 0.5) / size[0], (j + 0.5) / size[1], (k + 0.5) / size[2]);
                std::uint8_t region = background_region;
                double highest = 0.5 + roughness * uniform(-1, 1);
                for (int o = 0; o < num_organs; ++o) {
                    double height = 0;
                    for (const Bump& bump : organs[o])
                        height += bump.height * std::exp(-(at - bump.centre).squaredNorm() /
                                                         (2 * bump.width * bump.width));
                    if (height <= highest) continue;
                    highest = height;
                    region = static_cast<std::uint8_t>(first_organ_region + o);
                }
                image.voxels.push_back(region);
            }
    return image;
}

double largest_volume_error(const MeshQuality& quality, const std::vector<double>& expected) {
    double largest = 0;
    for (std::size_t r = 1; r < expected.size(); ++r)
        if (expected[r] > 0)
            largest = std::max(largest, std::abs(quality.region_volume_mm3[r] / expected[r] - 1));
    return largest;
}

void mesh(unsigned seed) {
    const auto begin = Clock::now();
    const RegionImage image = random_blobs(seed);
    Index num_regions = first_organ_region;
    for (const std::uint8_t region : image.voxels)
        num_regions = std::max<Index>(num_regions, region + 1);
    const LabelField field(image, num_regions);
    MesherOptions options;
    options.num_nodes = 3000;
    options.time_limit_s = 30;
    options.edge_length_mm = 2 * std::cbrt(image.grid.voxel_volume());
    options.outer_edge_length_mm = 4 * options.edge_length_mm;
    MesherSummary summary;
    SurfaceOptions edges{options.edge_length_mm, options.outer_edge_length_mm};
    const RegionSurface surface = extract_surfaces_finely(image, field, edges);
    options.edge_length_mm = edges.edge_length_mm;
    options.outer_edge_length_mm = edges.outer_edge_length_mm;
    make_mesh(surface, image, field, {}, options, &summary);
    fmt::print("{} meshed {} {} {:.2f} {:.4f} {:.1f}\n", seed,
               summary.mesher.substr(0, summary.mesher.find(' ')), summary.quality.num_inverted,
               summary.quality.min_dihedral_deg,
               largest_volume_error(summary.quality, voxel_volumes(image, num_regions)),
               std::chrono::duration<double>(Clock::now() - begin).count());
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    for (int seed = std::stoi(argv[1]); seed <= std::stoi(argv[2]); ++seed) {
        try {
            palpate::mesh(static_cast<unsigned>(seed));
        } catch (const palpate::Error& error) {
            fmt::print("{} failed {} {}\n", seed, exit_code_of(error.code()), error.what());
        }
        std::fflush(stdout);
    }
    return 0;
}
