// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>

#include "host/apps/aspirate/model/aspiration_model.hpp"
#include "host/apps/aspirate/profile_axis.hpp"

namespace palpate {
namespace {

// Stiffness of the tube over that of the tissue at the peak, per mm. With 300 tissue sinks in by so
// much that gamma comes out 2 to 4 % too high (docs/aspiration.md).
constexpr double contact_factor = 3000;

constexpr int most_hidden_places = 3;      // at which the hidden part of the rest may be wrong
constexpr double between_places_mm = 0.3;  // at least
constexpr double unseen_sd_mm = 0.6;       // of it where nothing is seen at rest
constexpr double hidden_sd_mm = 0.2;       // of it
constexpr double tilt_sd = 0.01;           // of the camera about its axis, rad
// Of the axis: half a pixel where its column is told, else as the outlines' symmetry tells it.
constexpr double told_axis_sd_px = 0.5;

/// Where the surface at rest may be off: between the last that was seen of it and the farthest that
/// is seen later; if nothing was seen, on the axis, too. Farther out only what is nearer tells, as
/// with a lever: a place there would take up what the model has wrong by a micrometre as a
/// millimetre. Empty if hardly anything comes out from behind the rim.
std::vector<double> hidden_places_of(const SuckedBody& sucked) {
    const double hidden_mm = sucked.seen_later_to_mm - sucked.seen_to_mm;
    std::vector<double> places;
    const int count = std::min(most_hidden_places, int(hidden_mm / between_places_mm));
    if (count < 1) return places;
    for (int k = sucked.seen_to_mm > 0 ? 1 : 0; k <= count; ++k)
        places.push_back(sucked.seen_to_mm + hidden_mm * k / count);
    return places;
}

/// Of the first guess, from which the surface may have been moved.
std::string rest_error_text(const SuckedBody& sucked) {
    const std::vector<double> places = hidden_places_of(sucked);
    if (places.empty()) return "";
    const bool is_seen = sucked.seen_to_mm > 0;
    std::string text = "rest_error = [";
    if (is_seen) text += fmt::format("{{r_mm = {:.4f}, z_mm = 0}}, ", sucked.seen_to_mm);
    for (std::size_t k = 0; k < places.size(); ++k)
        text += fmt::format("{{r_mm = {:.4f}, z_mm = {{value = {:.6f}, sd = {}}}}}, ", places[k],
                            sucked.moved_mm.empty() ? 0.0 : -sucked.moved_mm[k],
                            is_seen ? hidden_sd_mm : unseen_sd_mm);
    return text + fmt::format("{{r_mm = {:.4f}, z_mm = 0}}]\n", sucked.rest.r_mm.back());
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
    body.kappa_kpa = settings.kappa_over_young * sucked.start.peak_stiffness_kpa;
    body.contact_kpa_per_mm = contact_factor * sucked.start.peak_stiffness_kpa;
    return body;
}

/// Beyond the last place nothing is seen later either: there the surface is hardly higher than a
/// straight line to the rim, whatever the guess was before it was moved.
void bound_outer_part(double last_mm, RestSurface& rest) {
    constexpr double bulge = 1.1;  // a cap that is a part of a sphere stands so high over the line
    const double end_mm = rest.r_mm.back();
    double height_mm = 0;
    for (std::size_t k = 0; k + 1 < rest.r_mm.size(); ++k) {
        if (rest.r_mm[k] <= last_mm) {
            height_mm = rest.z_mm[k] * (end_mm - last_mm) / (end_mm - rest.r_mm[k]);
            continue;
        }
        const double line_mm = height_mm * (end_mm - rest.r_mm[k]) / (end_mm - last_mm);
        rest.z_mm[k] = std::min(rest.z_mm[k], bulge * line_mm);
    }
}

/// Linear between its points.
double height_at(const RestSurface& surface, double r_mm) {
    const auto right = std::upper_bound(surface.r_mm.begin(), surface.r_mm.end() - 1, r_mm);
    const auto k = std::size_t(std::max<std::ptrdiff_t>(1, right - surface.r_mm.begin()));
    const double share = (r_mm - surface.r_mm[k - 1]) / (surface.r_mm[k] - surface.r_mm[k - 1]);
    return surface.z_mm[k - 1] + share * (surface.z_mm[k] - surface.z_mm[k - 1]);
}

/// "of term 2" from the second term of the relaxation on.
std::string of_term(const std::string& number) { return number == "1" ? "" : " of term " + number; }

/// Profiles from elsewhere have no columns.
double axis_sd_mm(const AspirationSettings& settings) {
    const double pixel_mm = settings.pixel_r_um.value / 1000;
    return settings.instrument.axis_column_px && pixel_mm > 0 ? told_axis_sd_px * pixel_mm
                                                              : found_axis_sd_mm;
}

/// The r of each place of `rest_error`, as they stand in a text of `rest_error_text`.
std::vector<std::string> places_in(const std::string& text) {
    const std::size_t begin = text.find("rest_error = ");
    if (begin == std::string::npos) return {};
    const std::string line = text.substr(begin, text.find('\n', begin) - begin);
    static const std::regex place(R"(r_mm = ([0-9.]+))");
    std::vector<std::string> places;
    for (std::sregex_iterator one(line.begin(), line.end(), place), end; one != end; ++one)
        places.push_back(fmt::format("{:.2f}", std::stod((*one)[1])));
    return places;
}

/// What a number of `experiment_text` is in words of the settings file; empty: not known.
std::string words_of(const std::string& path, const std::vector<std::string>& places) {
    static const std::map<std::string, std::string> words{
        {"material[1].mu_kpa", "mu"},
        {"material[1].gamma", "gamma"},
        {"material[1].c1_kpa", "c1"},
        {"material[1].c2_kpa", "c2"},
        {"mesh.graded.depth_mm", "depth_mm"},
        {"obstacle[1].hole_radius_mm", "half of hole_diameter_mm"},
        {"obstacle[1].edge_radius_mm", "edge_radius_mm"},
        {"obstacle[1].friction", "friction"},
        {"data[1].r_scale", "told pixel_r_um over the true one"},
        {"data[1].z_scale", "told pixel_z_um over the true one"},
        {"data[1].delay_s", "delay_s"},
        {"data[1].tilt", "turn of the camera"},
        {"data[1].r_offset_mm", "axis off its column"}};
    static const std::regex of_relaxation(
        R"(material\[1\]\.relaxation\[(\d+)\]\.(amplitude|time_s))"),
        of_rest(R"(data\[1\]\.rest_error\[(\d+)\]\.z_mm)");
    if (const auto found = words.find(path); found != words.end()) return found->second;
    std::smatch found;
    if (std::regex_match(path, found, of_relaxation))
        return (found[2] == "amplitude" ? "C" : "tau") + of_term(found[1]);
    if (std::regex_match(path, found, of_rest))
        return fmt::format("hidden surface at rest, r = {} mm",
                           places.at(std::stoul(found[1]) - 1));
    return "";
}

}  // namespace

Experiment tissue_experiment(const std::string& text, const std::filesystem::path& folder) {
    Experiment experiment = Experiment::parse(text, "the aspiration's model", folder);
    const std::vector<std::string> places = places_in(text);
    experiment.set_words([&](const std::string& path) { return words_of(path, places); });
    return experiment;
}

bool is_rest_error(const std::string& path) { return path.find("rest_error") != std::string::npos; }

double move_rest(SuckedBody& sucked, const std::vector<double>& by_mm) {
    std::vector<double> r_mm = hidden_places_of(sucked), z_mm = by_mm;
    const std::vector<double> before_mm = sucked.rest.z_mm;
    std::vector<double> wanted_mm = before_mm;
    if (sucked.seen_to_mm > 0) {
        r_mm.insert(r_mm.begin(), sucked.seen_to_mm);
        z_mm.insert(z_mm.begin(), 0);
    }
    RestSurface& rest = sucked.rest;
    const double end_mm = rest.r_mm.back();
    r_mm.push_back(end_mm);
    z_mm.push_back(0);
    for (std::size_t k = 0; k + 1 < rest.r_mm.size(); ++k)
        for (std::size_t p = 1; p < r_mm.size(); ++p) {
            const double share = (rest.r_mm[k] - r_mm[p - 1]) / (r_mm[p] - r_mm[p - 1]);
            if (share < 0 || share >= 1) continue;
            wanted_mm[k] += z_mm[p - 1] + share * (z_mm[p] - z_mm[p - 1]);
            rest.z_mm[k] = hidden_height(rest.r_mm[k], wanted_mm[k], end_mm);
        }
    // Behind what is seen it falls outwards, at most by 45 degrees.
    for (std::size_t k = rest.r_mm.size() - 1; k-- > 0 && rest.r_mm[k] > sucked.seen_to_mm;) {
        const double outer_mm = rest.z_mm[k + 1];
        rest.z_mm[k] =
            std::clamp(rest.z_mm[k], outer_mm, outer_mm + rest.r_mm[k + 1] - rest.r_mm[k]);
    }
    bound_outer_part(r_mm[r_mm.size() - 2], rest);
    // What tissue cannot do it has not done: the prior counts from where it is.
    RestSurface wanted{rest.r_mm, wanted_mm}, moved = rest;
    for (std::size_t k = 0; k < before_mm.size(); ++k) {
        wanted.z_mm[k] -= before_mm[k];
        moved.z_mm[k] -= before_mm[k];
    }
    const std::vector<double> places = hidden_places_of(sucked);
    sucked.moved_mm.resize(by_mm.size(), 0.0);
    for (std::size_t k = 0; k < by_mm.size(); ++k) {
        const double all_mm = height_at(wanted, places[k]), done_mm = height_at(moved, places[k]);
        const double share = all_mm != 0 ? std::clamp(done_mm / all_mm, 0.0, 1.0) : 1;
        sucked.moved_mm[k] += share * by_mm[k];
    }
    double most_mm = 0;
    for (std::size_t k = 0; k < before_mm.size(); ++k)
        most_mm = std::max(most_mm, std::abs(rest.z_mm[k] - before_mm[k]));
    return most_mm;
}

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
               "r_scale = {}\nz_scale = {}\ndelay_s = {}\ntilt = {{value = 0, sd = {}}}\n"
               "r_offset_mm = {{value = 0, sd = {:.4g}}}\n",
               points_file, settings.pixel_r_um.scale_text(), settings.pixel_z_um.scale_text(),
               settings.delay_s.text(), tilt_sd, axis_sd_mm(settings)) +
           rest_error_text(sucked);
}

}  // namespace palpate
