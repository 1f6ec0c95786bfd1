// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "host/apps/phantom/pelvis.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "solver/base/locked_folder.hpp"

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
        {"load_family", name_of(options.load)},
        {"anatomy", name_of(options.anatomy)},
        {"material", name_of(options.law)},
        {"regions", regions_to_json(phantom, options)},
        {"mesh",
         {{"nodes", phantom.mesh.mesh.num_nodes()},
          {"elements", phantom.mesh.mesh.num_tets()},
          {"mesher", truth.mesher.mesher}}},
        {"load",
         {{"description",
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

void write_text(const fs::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw Error(ErrorCode::output_failed, "Cannot write " + path.string() + ".");
}

/// Brings a file or folder to the disk, so that the rename after it never shows half of it.
void sync_to_disk(const fs::path& path) {
    const int handle = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_synced = handle >= 0 && ::fsync(handle) == 0;
    if (handle >= 0) ::close(handle);
    if (!is_synced) {
        throw Error(ErrorCode::output_failed, "Cannot bring " + path.string() + " to the disk: " +
                                                  std::generic_category().message(errno) + ".");
    }
}

void write_surfaces(const PelvisPhantom& phantom, const fs::path& folder) {
    const auto& organs = phantom.settings.organs;
    for (std::size_t k = 0; k < organs.size(); ++k) {
        if (organs[k].role == Role::fixed) continue;
        const Index region = first_organ_region + static_cast<Index>(k);
        write_text(folder / ("target_" + organs[k].name + ".ply"),
                   to_ply(deformed_surface(phantom, region)));
    }
}

void write_files(const PelvisPhantom& phantom, const PelvisOptions& options,
                 const fs::path& folder) {
    write_label_image(folder / "reference.nii.gz", phantom.reference);
    write_label_image(folder / "target.nii.gz", phantom.target);
    write_text(folder / "organs.toml", to_toml(phantom.settings));
    write_text(folder / "truth.json", truth_to_json(phantom, options));
    write_text(folder / "landmarks.csv", landmarks_to_csv(phantom));
    write_surfaces(phantom, folder);
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
        sync_to_disk(file.path());
    }
    sync_to_disk(folder);
}

}  // namespace

void write_pelvis(const PelvisPhantom& phantom, const PelvisOptions& options,
                  const fs::path& folder) {
    try {
        fs::path final_path = fs::absolute(folder).lexically_normal();
        if (!final_path.has_filename()) final_path = final_path.parent_path();
        if (fs::exists(final_path)) {
            throw Error(ErrorCode::output_failed,
                        "The folder " + folder.string() + " exists already; name a new one.");
        }
        fs::create_directories(final_path.parent_path());
        LockedFolder temporary(final_path.parent_path(),
                               fmt::format(".{}.unfinished-", final_path.filename().string()),
                               LockedFolder::Readers::everybody);
        write_files(phantom, options, temporary.path());
        fs::rename(temporary.path(), final_path);
        temporary.keep();
        sync_to_disk(final_path.parent_path());
    } catch (const fs::filesystem_error& error) {
        throw Error(ErrorCode::output_failed,
                    "The phantom could not be written: " + std::string(error.what()) + ".");
    }
}

}  // namespace palpate
