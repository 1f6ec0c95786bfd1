// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/model/aspiration_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "host/apps/simulate/graded_mesh.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

constexpr double sample_mm = 0.25, cap_power = 1.25, wall_factor = 2.05;

// Of a film with a sharp edge (0.13 mm) heights are then off by 5 um at most in a travel of 1.3 mm;
// with the usual 13 rows from 0.25 mm on they are by 25 um.
constexpr int columns_outside = 8, rows = 24;
constexpr double finest_mm = 0.12;

std::string list_of(const std::vector<double>& values) {
    std::string text;
    for (const double value : values)
        text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", value);
    return "[" + text + "]";
}

/// The suction acts so far, under about half of the rim: on tissue that comes off it, too. Where it
/// touches, the rim bears as much more. A little beyond the line of columns next to the middle that
/// a mesh of twice the cells' size has, too: finer and coarser meshes have the same end.
double end_of_suction_mm(const AspirationBody& body) {
    constexpr double beyond = 0.05;  // of the next column: less than a column of any finer mesh
    GradedSettings graded;
    graded.width_mm = body.width_mm;
    graded.columns_outside = columns_outside;
    graded.face = TubeFace{0.5 * body.hole_diameter_mm.value, body.edge_radius_mm.value};
    graded.edge_mm = graded.face->end_mm();
    const std::vector<double> columns = graded_columns(graded);
    const double middle_mm = 0.25 * (body.hole_diameter_mm.value + body.outer_diameter_mm);
    std::size_t end = 0;  // each second line is one of the coarser mesh
    for (std::size_t k = 2; k + 1 < columns.size(); k += 2)
        if (std::abs(columns[k] - middle_mm) < std::abs(columns[end] - middle_mm)) end = k;
    return columns[end] + beyond * (columns[end + 1] - columns[end]);
}

std::string tissue_text(const AspirationBody& body) {
    std::string text = fmt::format("[[material]]\nlaw = \"{}\"\n", body.tissue.law);
    for (const auto& [name, value] : body.tissue.parameters)
        text += fmt::format("{} = {}\n", name, value);
    // the volumetric part of reduced-polynomial is (J - 1)^2 / d1
    text += body.tissue.law == "reduced-polynomial"
                ? fmt::format("d1_per_kpa = {:.6g}\n", 2 / body.kappa_kpa)
                : fmt::format("kappa_kpa = {:.6g}\n", body.kappa_kpa);
    std::string terms;
    for (const auto& [amplitude, time_s] : body.tissue.relaxation)
        terms += fmt::format("{}{{amplitude = {}, time_s = {}}}", terms.empty() ? "" : ", ",
                             amplitude, time_s);
    return text + (terms.empty() ? "" : "relaxation = [" + terms + "]\n");
}

}  // namespace

std::string open_from(double start) {
    return fmt::format("{{unknown = true, start = {:.5g}}}", start);
}

AspirationBody AspirationBody::of(const AspirationSettings& settings) {
    AspirationBody body;
    body.title = "Tissue sucked into a tube";
    body.hole_diameter_mm = settings.hole_diameter_mm;
    body.edge_radius_mm = settings.edge_radius_mm;
    body.outer_diameter_mm = settings.outer_diameter_mm;
    body.depth_mm = settings.depth_mm;
    body.width_mm = settings.width_mm;
    body.side = settings.side;
    body.friction = settings.friction;
    body.refine = settings.refine;
    return body;
}

std::string aspiration_model_text(const AspirationBody& body) {
    std::string text = fmt::format("title = \"{}\"\n\n", body.title);
    text += fmt::format(
        "[mesh]\nformulation = \"axisymmetric\"\nvolume = \"element-mean\"\n\n[mesh.graded]\n"
        "width_mm = {:.6g}\ndepth_mm = {}\nedge_of = \"tube\"\ncolumns_outside = {}\nrows = {}\n"
        "finest_mm = {}\nrefine = {}\n",
        body.width_mm, body.depth_mm.held_text(), columns_outside, rows, finest_mm, body.refine);
    text += fmt::format("surface_x_mm = {}\nsurface_y_mm = {}\n\n", list_of(body.rest.r_mm),
                        list_of(body.rest.z_mm));
    text += tissue_text(body);
    text += "\n[[fix]]\nname = \"bottom\"\nwhere = {side = \"y-min\"}\n";
    if (body.side != TissueSide::free)
        text += "\n[[fix]]\nname = \"side\"\nwhere = {side = \"x-max\"}\n";
    if (body.side == TissueSide::slides) text += "components = \"x\"\n";
    text += fmt::format(
        "\n[[obstacle]]\nname = \"tube\"\nshape = \"tube\"\nplace_mm = [0, 0]\n"
        "direction = [0, -1]\nhole_radius_mm = {}\nedge_radius_mm = {}\nouter_radius_mm = {:.6g}\n"
        "outer_edge_radius_mm = {:.6g}\nstiffness_kpa_per_mm = {:.6g}\nfriction = {}\n"
        "where = {{point_array = \"surface\"}}\n",
        body.hole_diameter_mm.held_text(0.5), body.edge_radius_mm.held_text(),
        0.5 * body.outer_diameter_mm,
        std::min(body.edge_radius_mm.value, 0.1 * body.hole_diameter_mm.value),
        body.contact_kpa_per_mm, body.friction.text());
    text += fmt::format(
        "\n[[pressure]]\nname = \"suction\"\nwhere = {{point_array = \"surface\", to_mm = [{:.6g}, "
        "100]}}\nkpa = {:.8g}\nfollows = true\ncolumn = \"share\"\n",
        end_of_suction_mm(body), -body.peak_kpa);
    text += fmt::format("\n[history]\ntime_s = {}\nshare = {}\n", list_of(body.steps.time_s),
                        list_of(body.steps.share));
    return text;
}

void limit_bulk_modulus(double most_kpa, SimulationSettings& settings) {
    for (MaterialSettings& one : settings.materials) {
        const MaterialDescription& law = material_law(one.material.law);
        for (std::size_t k = 0; k < law.parameters.size(); ++k) {
            double& value = one.material.parameters[k];
            if (law.parameters[k].name == "kappa_kpa") value = std::min(value, most_kpa);
            if (law.parameters[k].name == "d1_per_kpa") value = std::max(value, 2 / most_kpa);
        }
    }
}

RestSurface cap_surface(double height_mm, double hole_radius_mm, double edge_radius_mm) {
    RestSurface rest;
    const double end = hole_radius_mm + edge_radius_mm;
    const int count = std::max(3, int(std::ceil(end / sample_mm)));
    for (int k = 0; k <= count; ++k) {
        const double r = end * k / count, part = 1 - r * r / (hole_radius_mm * hole_radius_mm);
        const double z = part > 0 ? height_mm * std::pow(part, cap_power) : 0;
        rest.r_mm.push_back(r);
        rest.z_mm.push_back(z);
    }
    return rest;
}

double theret_stiffness(double suction_kpa, double hole_radius_mm, double travel_mm) {
    return 3 * wall_factor * suction_kpa * hole_radius_mm / (2 * std::numbers::pi * travel_mm);
}

}  // namespace palpate
