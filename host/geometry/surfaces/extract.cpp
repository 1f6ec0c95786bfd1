// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/extract.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include "host/geometry/surfaces/interfaces.hpp"
#include "host/geometry/surfaces/label_lattice.hpp"
#include "host/geometry/surfaces/remesh.hpp"
#include "host/geometry/surfaces/repair.hpp"
#include "host/geometry/surfaces/size_field.hpp"
#include "host/geometry/surfaces/surface_complex.hpp"
#include "host/geometry/surfaces/volumes.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::vector<double> voxel_volumes(const RegionImage& image, Index num_regions) {
    std::vector<double> volumes(std::size_t(num_regions), 0.0);
    for (std::uint8_t region : image.voxels) volumes[region] += image.grid.voxel_volume();
    return volumes;
}

void check_input(const RegionImage& image, const LabelField& field, const SurfaceOptions& options) {
    if (!(options.edge_length_mm > 0) || !(options.outer_edge_length_mm >= options.edge_length_mm))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("Edge lengths of {} mm on organs and {} mm outside are not usable; "
                                "the first must be positive and not above the second.",
                                options.edge_length_mm, options.outer_edge_length_mm));
    const auto largest = std::max_element(image.voxels.begin(), image.voxels.end());
    if (largest == image.voxels.end() || *largest >= beyond_box || *largest >= field.num_regions())
        throw Error(
            ErrorCode::invalid_argument,
            "The region image is empty or has region numbers that its field does not know.");
}

// An organ needs room for a closed surface of a few dozen triangles.
void check_sizes(const std::vector<double>& volumes, double edge_length_mm) {
    const double smallest = 4 * std::pow(edge_length_mm, 3);
    for (std::size_t r = first_organ_region; r < volumes.size(); ++r)
        if (volumes[r] > 0 && volumes[r] < smallest)
            throw Error(ErrorCode::input_unusable,
                        fmt::format("Region {} has a volume of {:.1f} mm^3, too small for an edge "
                                    "length of {} mm (at least {:.0f} mm^3); use a smaller edge "
                                    "length or leave the organ out.",
                                    r, volumes[r], edge_length_mm, smallest));
}

void check_all_left(const LabelLattice& lattice, const std::vector<double>& volumes,
                    double edge_length_mm) {
    std::vector<double> sampled(volumes.size(), 0.0);
    for (std::uint8_t label : lattice.labels) sampled[label] += lattice.spacing.prod();
    for (std::size_t r = first_organ_region; r < volumes.size(); ++r)
        if (sampled[r] < 0.5 * volumes[r])
            throw Error(ErrorCode::input_unusable,
                        fmt::format("Region {} is too thin for an edge length of {} mm: most of it "
                                    "lies in parts thinner than that; use a smaller edge length or "
                                    "leave the organ out.",
                                    r, edge_length_mm));
}

struct Attempt {
    double cell_share;  ///< lattice cell / edge length
    int rounds;         ///< of remeshing
};

SurfaceComplex make_complex(const RegionImage& image, const LabelField& field,
                            const SurfaceOptions& options, const Attempt& attempt,
                            const std::vector<double>& volumes, const ProgressSink& progress) {
    const double edge = options.edge_length_mm;
    LabelLattice lattice = sample_labels(image, field, attempt.cell_share * edge);
    check_cancelled(progress);
    even_out_contacts(lattice, 8);
    remove_thin_parts(lattice, image.grid, field);
    remove_specks(lattice, 4 * std::pow(edge, 3));
    make_well_composed(lattice, image.grid, field);
    check_all_left(lattice, volumes, edge);
    check_cancelled(progress);
    SurfaceComplex complex = boundary_of(lattice);
    Interfaces interfaces(field, image.grid);
    relax_staircase(complex, interfaces, 0.5 * lattice.spacing, 6);
    check_cancelled(progress);
    const SizeField size(lattice, edge, options.outer_edge_length_mm);
    remesh(complex, interfaces, size, attempt.rounds, progress);
    for (int round = 0; round < 3; ++round) {
        check_cancelled(progress);
        match_volumes(complex, interfaces, volumes, 2);
        check_cancelled(progress);
        polish(complex, interfaces, size);
    }
    check_cancelled(progress);
    match_volumes(complex, interfaces, volumes, 2);
    check_cancelled(progress);
    untangle(complex, 12);
    return complex;
}

// What is wrong with a complex, in words; empty if nothing.
std::string complaint(const SurfaceComplex& complex, const std::vector<double>& volumes,
                      double tolerance) {
    const auto crossing = crossing_faces(complex);
    if (!crossing.empty()) {
        const auto& face = complex.faces[crossing.front()[0]];
        return fmt::format("{} pairs of triangles cross, the first at regions {} and {}",
                           crossing.size(), face.regions[0], face.regions[1] % beyond_box);
    }
    const auto enclosed = enclosed_volumes(complex, Index(volumes.size()));
    for (std::size_t r = 1; r < volumes.size(); ++r)
        if (std::abs(enclosed[r] - volumes[r]) > tolerance * volumes[r])
            return fmt::format("region {} encloses {:.0f} mm^3 instead of {:.0f} mm^3", r,
                               enclosed[r], volumes[r]);
    return {};
}

RegionSurface to_surface(SurfaceComplex complex, const ImageGrid& grid) {
    for (auto& face : complex.faces)  // no surface between outside and outside
        if (face.regions[0] == outside_region && face.regions[1] == beyond_box) face.v[0] = -1;
    complex.compact();
    const bool mirrored = grid.direction.determinant() < 0;
    RegionSurface surface;
    const Vec3 corner = grid.to_point(Vec3::Constant(-0.5));
    for (const Vec3& point : complex.points)
        surface.vertices.push_back(corner + grid.direction * point);
    for (const auto& face : complex.faces) {
        Triangle triangle = face.v;
        if (mirrored) std::swap(triangle[1], triangle[2]);
        std::array<Index, 2> regions{face.regions[0], face.regions[1]};
        if (regions[1] == beyond_box) regions[1] = outside_region;
        surface.triangles.push_back(triangle);
        surface.regions.push_back(regions);
        surface.on_image_border.push_back(face.plane >= 0);
    }
    return surface;
}

SurfaceSummary summarise(const SurfaceComplex& complex, const std::vector<double>& volumes) {
    SurfaceSummary summary;
    const auto enclosed = enclosed_volumes(complex, Index(volumes.size()));
    std::vector<bool> is_cut(volumes.size(), false);
    for (const auto& face : complex.faces)
        if (face.plane >= 0) is_cut[face.regions[0]] = true;
    for (std::size_t r = 1; r < volumes.size(); ++r)
        if (volumes[r] > 0)
            summary.regions.push_back({Index(r), volumes[r], enclosed[r], is_cut[r]});
    return summary;
}

}  // namespace

RegionSurface extract_surfaces(const RegionImage& image, const LabelField& field,
                               const SurfaceOptions& options, SurfaceSummary* summary,
                               const ProgressSink& progress) {
    const auto start = std::chrono::steady_clock::now();
    check_input(image, field, options);
    const auto volumes = voxel_volumes(image, field.num_regions());
    check_sizes(volumes, options.edge_length_mm);
    std::string reason;
    constexpr Attempt attempts[] = {{0.5, 6}, {0.45, 6}, {0.4, 6}};
    for (const Attempt& attempt : attempts) {
        report_progress(
            progress, "surfaces", -1,
            reason.empty() ? "" : fmt::format("again with a finer lattice: {}", reason));
        SurfaceComplex complex = make_complex(image, field, options, attempt, volumes, progress);
        reason = complaint(complex, volumes, options.volume_tolerance);
        if (!reason.empty()) continue;
        if (summary) {
            *summary = summarise(complex, volumes);
            summary->seconds =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        }
        return to_surface(std::move(complex), image.grid);
    }
    throw Error(ErrorCode::mesh_failed,
                fmt::format("No valid surface with edges of {} mm could be made: {}; use a smaller "
                            "edge length.",
                            options.edge_length_mm, reason));
}

RegionSurface extract_surfaces_finely(const RegionImage& image, const LabelField& field,
                                      SurfaceOptions& options, std::string* reason,
                                      const ProgressSink& progress) {
    const SurfaceOptions asked = options;
    const double voxel_mm = std::cbrt(image.grid.voxel_volume());
    std::exception_ptr first;
    struct Rung {
        double share;  ///< of the edge length
        double tolerance;
    };
    constexpr double wide = 0.05;
    for (const auto& [share, tolerance] :
         {Rung{1, 0}, Rung{0.7, 0}, Rung{0.5, 0}, Rung{1, wide}, Rung{0.5, wide}}) {
        options.edge_length_mm = share * asked.edge_length_mm;
        options.outer_edge_length_mm = share * asked.outer_edge_length_mm;
        options.volume_tolerance = std::max(asked.volume_tolerance, tolerance);
        if (first && options.edge_length_mm < 0.99 * voxel_mm) continue;
        try {
            return extract_surfaces(image, field, options, nullptr, progress);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::input_unusable && error.code() != ErrorCode::mesh_failed)
                throw;
            if (!first && reason) *reason = error.what();
            if (!first) first = std::current_exception();
            report_progress(progress, "surfaces", -1, fmt::format("once more: {}", error.what()));
        }
    }
    std::rethrow_exception(first);
}

}  // namespace palpate
