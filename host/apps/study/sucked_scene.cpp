// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/sucked_scene.hpp"

#include <fmt/format.h>

#include "host/io/output_folder.hpp"

namespace palpate {
namespace {

constexpr double cap_mm = 1, rise_s = 3.5, fall_s = 6.5, released_s = 9.5;
constexpr double contact_factor = 300;  // stiffness of the tube over that of the tissue, per mm
constexpr double sample_mm = 0.25, lowest_mm = 0.62;
constexpr const char* points_file = "points.csv";

}  // namespace

double SuckedScene::stiffness_kpa() const {
    return theret_stiffness(peak_kpa, hole_radius_mm, travel_mm);
}

AspirationBody SuckedScene::body() const {
    AspirationBody body;
    body.title = "Tissue sucked into a tube";
    body.hole_diameter_mm = {2 * hole_radius_mm};
    body.edge_radius_mm = {edge_radius_mm};
    body.friction = {friction};
    body.depth_mm = {16};
    body.outer_diameter_mm = 20;
    body.width_mm = 20;
    body.rest = cap_surface(cap_mm, hole_radius_mm, edge_radius_mm);
    body.kappa_kpa = kappa_kpa;
    body.contact_kpa_per_mm = contact_factor * stiffness_kpa();
    body.peak_kpa = peak_kpa;
    const Suction cycle{{0, rise_s, fall_s, released_s, film_s}, {0, peak_kpa, peak_kpa, 0, 0}};
    body.steps = suction_steps(cycle, film_s, num_steps);
    body.refine = refine;
    return body;
}

const char* SuckedScene::sentence() {
    return "A cap of 1 mm over a hole of 10 mm is sucked (rise 3.5 s, hold 3 s, release 3 s, 16 s "
           "in all).";
}

void write_sucked_points(const SuckedSurface& surface, const SuctionSteps& steps, double sd_mm,
                         const std::function<double()>& noise_mm,
                         const std::filesystem::path& folder) {
    std::string text = "time_s,r_mm,z_mm,sd_mm\n";
    for (const double time_s : steps.time_s)
        for (double r_mm = sample_mm; r_mm < SuckedScene::hole_radius_mm; r_mm += sample_mm) {
            const double z_mm = surface.z_mm(r_mm, time_s);
            if (z_mm > lowest_mm)
                text += fmt::format("{:.6f},{:.3f},{:.7f},{}\n", time_s, r_mm, z_mm + noise_mm(),
                                    sd_mm);
        }
    write_text_file(folder / points_file, text);
}

Experiment sucked_experiment(const AspirationBody& body, const std::filesystem::path& folder) {
    return Experiment::parse(
        aspiration_model_text(body) +
            fmt::format("\n[[data]]\nname = \"profiles\"\nkind = \"profile\"\nfile = \"{}\"\n"
                        "where = {{point_array = \"surface\"}}\n",
                        points_file),
        "the study's model", folder);
}

}  // namespace palpate
