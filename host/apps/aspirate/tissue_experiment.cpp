// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_experiment.hpp"

#include <fmt/format.h>

#include "host/apps/aspirate/model/aspiration_model.hpp"

namespace palpate {
namespace {

constexpr double contact_factor = 300;  // stiffness of the tube over that of the tissue, per mm

std::string open_from(double start) {
    return fmt::format("{{unknown = true, start = {:.5g}}}", start);
}

/// Every number of the law and of its relaxation is looked for, or as the start has it.
TissueText tissue_of(const std::string& law, int num_terms, const TissueStart& start,
                     bool is_open) {
    const auto number = [&](double value) {
        return is_open ? open_from(value) : fmt::format("{:.10g}", value);
    };
    TissueText tissue{law, {}, {}};
    if (law == "reduced-polynomial")
        tissue.parameters = {{"c1_kpa", number(start.mu_kpa)},
                             {"c2_kpa", number(0.5 * start.mu_kpa * start.gamma)}};
    else
        tissue.parameters = {{"mu_kpa", number(start.mu_kpa)}};
    if (law == "veronda-westmann") tissue.parameters.emplace_back("gamma", number(start.gamma));
    double time_s = num_terms > 1 ? start.relaxation_s / 3 : start.relaxation_s;
    for (int k = 0; k < num_terms; ++k, time_s *= 5)
        tissue.relaxation.emplace_back(number(start.amplitude / num_terms), number(time_s));
    return tissue;
}

AspirationBody body_of(const AspirationSettings& settings, const SuckedBody& sucked,
                       const Suction& suction) {
    AspirationBody body = AspirationBody::of(settings);
    body.rest = sucked.rest;
    body.steps = sucked.steps;
    body.peak_kpa = suction.peak_kpa();
    body.kappa_kpa = settings.kappa_over_shear * sucked.start.peak_stiffness_kpa;
    body.contact_kpa_per_mm = contact_factor * sucked.start.peak_stiffness_kpa;
    return body;
}

}  // namespace

std::string supposed_model_text(const AspirationSettings& settings, const SuckedBody& sucked,
                                const Suction& suction, const std::string& law, int num_terms) {
    AspirationBody body = body_of(settings, sucked, suction);
    body.tissue = tissue_of(law, num_terms, sucked.start, false);
    // what is known with an error is as it is told
    for (SettingNumber* number :
         {&body.hole_diameter_mm, &body.edge_radius_mm, &body.depth_mm, &body.friction})
        number->sd.reset();
    if (body.friction.is_unknown) body.friction = {supposed_friction};
    return aspiration_model_text(body);
}

std::string experiment_text(const AspirationSettings& settings, const SuckedBody& sucked,
                            const Suction& suction, const std::string& law, int num_terms) {
    AspirationBody body = body_of(settings, sucked, suction);
    body.tissue = tissue_of(law, num_terms, sucked.start, true);
    return aspiration_model_text(body) +
           fmt::format(
               "\n[[data]]\nname = \"profiles\"\nkind = \"profile\"\nfile = \"{}\"\n"
               "where = {{point_array = \"surface\"}}\nrest = \"measured\"\n"
               "r_scale = {}\nz_scale = {}\ndelay_s = {}\n",
               points_file, settings.pixel_r_um.scale_text(), settings.pixel_z_um.scale_text(),
               settings.delay_s.text());
}

}  // namespace palpate
