// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/apps/phantom/pelvis.hpp"
#include "host/io/delimited_text.hpp"
#include "host/io/output_folder.hpp"
#include "host/io/volume_files.hpp"
#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json to_json(const Vec3& v) { return Json::array({v[0], v[1], v[2]}); }

Json walls_to_json(const PelvisTruth& truth) {
    Json walls = Json::array();
    for (const WallTruth& wall : truth.walls) {
        walls.push_back({{"name", wall.name},
                         {"expansion_mm", wall.expansion_mm},
                         {"push_towards_prostate_mm", wall.push_mm},
                         {"tangential_mm", wall.tangential_mm},
                         {"shift_mm", to_json(wall.shift_mm)},
                         {"resultant_force_mn", to_json(wall.resultant_force_mn)}});
    }
    return walls;
}

double true_stiffness_kpa(const std::string& organ, const PelvisOptions& options) {
    if (!options.zone_stiffness_kpa) return options.stiffness_kpa;
    return options.zone_stiffness_kpa->at(organ == "transition_zone" ? 0 : 1);
}

Json regions_to_json(const PelvisPhantom& phantom, const PelvisOptions& options) {
    Json regions = Json::array({{{"name", "background"},
                                 {"label", 0},
                                 {"role", "background"},
                                 {"stiffness_kpa", options.background_stiffness_kpa},
                                 {"poisson_ratio", options.background_poisson_ratio}}});
    for (const OrganSettings& organ : phantom.settings.organs) {
        Json region{{"name", organ.name}, {"label", organ.label}, {"role", name_of(organ.role)}};
        if (organ.role == Role::tissue) {
            region["stiffness_kpa"] = true_stiffness_kpa(organ.name, options);
            region["poisson_ratio"] = options.poisson_ratio;
            if (options.tumour_fraction > 0) {
                region["tumour"] = {{"fraction", options.tumour_fraction},
                                    {"stiffness_kpa", options.tumour_stiffness_kpa}};
            }
        } else {
            region["hollow"] = true;
        }
        regions.push_back(region);
    }
    return regions;
}

std::string truth_to_json(const PelvisPhantom& phantom, const PelvisOptions& options) {
    const PelvisTruth& truth = phantom.truth;
    const Json json{
        {"phantom", "pelvis"},
        {"seed", options.seed},
        {"frame", "LPS, mm"},
        {"spacing_mm", to_json(options.spacing)},
        {"contours", to_text(options.contours)},
        {"load_family", name_of(truth.load_family)},
        {"anatomy", name_of(options.anatomy)},
        {"material", options.law.name},
        {"regions", regions_to_json(phantom, options)},
        {"mesh",
         {{"nodes", phantom.mesh.mesh.num_nodes()},
          {"elements", phantom.mesh.mesh.num_tets() /
                           (phantom.element == ElementType::tet10 ? pieces_of_tet10 : 1)},
          {"element_type", element_table(phantom.element).name},
          {"mesher", truth.mesher.mesher}}},
        {"load",
         {{"number", truth.load},
          {"description",
           "prescribed wall displacement = scale x (normal + shift + tangential); "
           "bones and box fixed"},
          {"scale", truth.load_scale},
          {"walls", walls_to_json(truth)}}},
        {"smallest_jacobian", truth.smallest_jacobian},
        {"solve_relative_residual", truth.solve_residual},
        {"peak_displacement_mm", truth.peak_displacement_mm},
        {"prostate_mean_displacement_mm", truth.prostate_mean_displacement_mm},
        {"prostate_shape_change_rms_mm", truth.prostate_shape_change_mm},
        {"prostate_shape_change_largest_mm", truth.prostate_largest_shape_change_mm},
    };
    return json.dump(2) + "\n";
}

std::string landmarks_to_csv(const PelvisPhantom& phantom) {
    std::string text = "x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm\n";
    for (std::size_t n = 0; n < phantom.landmarks.size(); ++n) {
        const Vec3 &x = phantom.landmarks[n], &u = phantom.landmark_displacements[n];
        text += fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", x[0], x[1], x[2], u[0],
                            u[1], u[2]);
    }
    return text;
}

/// Vertices (mm LPS) and triangles as text.
std::string to_ply(const Surface& surface) {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
        "property double z\nelement face {}\nproperty list uchar int vertex_indices\n"
        "end_header\n",
        surface.vertices.size(), surface.triangles.size());
    for (const Vec3& x : surface.vertices) {
        text += fmt::format("{:.6f} {:.6f} {:.6f}\n", x[0], x[1], x[2]);
    }
    for (const Triangle& t : surface.triangles) {
        text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    }
    return text;
}

/// The surface of a region in the target, as exact as the mesh.
Surface deformed_surface(const PelvisPhantom& phantom, Index region) {
    std::vector<Index> node_of;
    Surface surface = surface_of_region(phantom.mesh.surface, region, true, &node_of);
    for (std::size_t v = 0; v < node_of.size(); ++v) {
        surface.vertices[v] += phantom.displacement[node_of[v]];
    }
    return surface;
}

void write_surfaces(const PelvisPhantom& phantom, const fs::path& folder) {
    const auto& organs = phantom.settings.organs;
    for (std::size_t k = 0; k < organs.size(); ++k) {
        if (organs[k].role == Role::fixed) continue;
        const Index region = first_organ_region + static_cast<Index>(k);
        write_text_file(folder / ("target_" + organs[k].name + ".ply"),
                        to_ply(deformed_surface(phantom, region)));
    }
}

/// What belongs to the motion: all but the reference and the settings.
void write_target(const PelvisPhantom& phantom, const PelvisOptions& options,
                  const fs::path& folder) {
    write_label_image(folder / "target.nii.gz", phantom.target);
    write_text_file(folder / "truth.json", truth_to_json(phantom, options));
    write_text_file(folder / "landmarks.csv", landmarks_to_csv(phantom));
    write_surfaces(phantom, folder);
}

void write_reference(const PelvisPhantom& phantom, const fs::path& folder) {
    write_label_image(folder / "reference.nii.gz", phantom.reference);
    write_text_file(folder / "organs.toml", to_toml(phantom.settings));
}

}  // namespace

void write_pelvis(const PelvisPhantom& phantom, const PelvisOptions& options,
                  const fs::path& folder) {
    write_folder_atomically(folder, false, [&](const fs::path& inside) {
        write_reference(phantom, inside);
        write_target(phantom, options, inside);
    });
}

void write_pelvis_loads(const PelvisOptions& options,
                        const std::function<void(const PelvisSink& take)>& for_each,
                        const fs::path& folder) {
    write_folder_atomically(folder, false, [&](const fs::path& inside) {
        std::string pairs = delimited_line({"participant_id", "reference", "target"}, '\t');
        for_each([&](const PelvisPhantom& phantom) {
            if (phantom.truth.load == 1) write_reference(phantom, inside);
            const std::string target = fmt::format("target-{:02}", phantom.truth.load);
            make_folders(inside / target);
            write_target(phantom, options, inside / target);
            pairs += delimited_line({fmt::format("phantom-{}", options.seed), "reference.nii.gz",
                                     target + "/target.nii.gz"},
                                    '\t');
        });
        write_text_file(inside / "pairs.tsv", pairs);
    });
}

}  // namespace palpate
