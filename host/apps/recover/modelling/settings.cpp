// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "host/io/settings_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::uintmax_t largest_file_bytes = 1 << 20;
constexpr std::size_t longest_name = 64;
constexpr int largest_label = 65535;
constexpr NumberRange stiffness_range{0, 1e6, true};
constexpr NumberRange contour_sd_range{0, largest_contour_sd_mm};
constexpr NumberRange poisson_range{0, 0.499};
constexpr double narrowest_poisson_range = 0.02;
const std::string stiffness_choice = "\"unknown\" or a number greater than 0, in kPa";

/// A number, or "unknown".
template <typename Material>
void read_poisson_ratio(const SettingsTable& table, Material& material) {
    material.poisson_unknown = table.is_text("poisson_ratio", "unknown");
    if (material.poisson_unknown || !table.has("poisson_ratio")) return;
    try {
        material.poisson_ratio = *table.number("poisson_ratio", poisson_range);
    } catch (const Error&) {
        table.refuse("poisson_ratio", "allowed: \"unknown\" or a number from 0 to 0.499");
    }
}

Index read_label(const SettingsTable& table) {
    const auto label = table.whole_number("label", 1, largest_label);
    if (!label) table.missing("label", fmt::format("a whole number from 1 to {}", largest_label));
    return *label;
}

std::string read_name(const SettingsTable& table) {
    const auto name = table.text("name");
    if (!name) table.missing("name", "text in quotes, for example \"prostate\"");
    const bool printable = std::none_of(name->begin(), name->end(),
                                        [](unsigned char c) { return c < 0x20 || c == 0x7f; });
    if (name->empty() || name->size() > longest_name || !printable)
        table.refuse("name", fmt::format("allowed: 1 to {} printable characters", longest_name));
    return *name;
}

Role read_role(const SettingsTable& table) {
    const auto role = table.choice("role", {"tissue", "driven", "fixed"});
    if (!role) table.missing("role", "\"tissue\", \"driven\", \"fixed\"");
    if (*role == "tissue") return Role::tissue;
    return *role == "driven" ? Role::driven : Role::fixed;
}

bool read_hollow(const SettingsTable& table, Role role) {
    const bool hollow = table.yes_or_no("hollow").value_or(role != Role::tissue);
    if (role == Role::tissue && hollow)
        table.refuse("hollow", "allowed for role \"tissue\": false, because tissue is meshed");
    if (role == Role::fixed && !hollow)
        table.refuse("hollow", "allowed for role \"fixed\": true, because it does not deform");
    return hollow;
}

void refuse_material_of_hollow(const SettingsTable& table) {
    for (const char* key : {"stiffness_kpa", "poisson_ratio"})
        if (table.has(key))
            table.refuse(key,
                         "allowed: nothing, because the organ is hollow; remove the key, or set "
                         "hollow = false for a driven organ with solid contents");
}

void read_material(const SettingsTable& table, OrganSettings& organ) {
    if (organ.hollow) return refuse_material_of_hollow(table);
    if (!table.has("stiffness_kpa")) table.missing("stiffness_kpa", stiffness_choice);
    if (table.is_text("stiffness_kpa", "unknown")) {
        organ.stiffness_kpa.reset();
    } else {
        // A text such as "soft" must hear about "unknown", a number out of range about the range.
        try {
            organ.stiffness_kpa = table.number("stiffness_kpa", stiffness_range);
        } catch (const Error&) {
            table.refuse("stiffness_kpa", "allowed: " + stiffness_choice + ", at most 1e6");
        }
    }
    read_poisson_ratio(table, organ);
}

OrganSettings read_organ(SettingsTable table) {
    OrganSettings organ;
    organ.name = read_name(table);
    table.set_subject(organ.name);
    table.allow_keys({"name", "label", "role", "hollow", "stiffness_kpa", "poisson_ratio"});
    organ.label = read_label(table);
    organ.role = read_role(table);
    organ.hollow = read_hollow(table, organ.role);
    read_material(table, organ);
    return organ;
}

BackgroundSettings read_background(const SettingsTable& table) {
    table.allow_keys({"label", "stiffness_kpa", "poisson_ratio", "outer_boundary"});
    BackgroundSettings result;
    if (const auto label = table.whole_number("label", 0, largest_label)) result.label = *label;
    result.stiffness_kpa =
        table.number("stiffness_kpa", stiffness_range).value_or(result.stiffness_kpa);
    read_poisson_ratio(table, result);
    const auto outer = table.choice("outer_boundary", {"fixed", "free"});
    result.outer_boundary_fixed = outer.value_or("fixed") == "fixed";
    return result;
}

std::optional<double> read_contour_sd(const SettingsTable& table) {
    if (table.is_text("contour_sd_mm", "unknown")) return std::nullopt;
    try {
        return table.number("contour_sd_mm", contour_sd_range);
    } catch (const Error&) {
        table.refuse("contour_sd_mm", "allowed: a number of mm from 0 to 5, or \"unknown\"");
    }
}

/// `contour_style`: whether contours were drawn slice by slice.
std::optional<bool> read_contour_style(const SettingsTable& table) {
    const auto style = table.choice("contour_style", {"unknown", "surface", "slices"});
    if (!style || *style == "unknown") return std::nullopt;
    return *style == "slices";
}

PriorSettings read_prior(const SettingsTable& table) {
    table.allow_keys({"noise_voxels", "contour_sd_mm", "contour_style", "displacement_sd_mm",
                      "displacement_range_mm", "stiffness_median_ratio", "stiffness_sd_ln",
                      "poisson_lowest", "poisson_highest"});
    PriorSettings p;
    const auto read = [&](const char* key, NumberRange range, double& field) {
        field = table.number(key, range).value_or(field);
    };
    read("noise_voxels", {0, 10, true}, p.noise_voxels);
    p.contour_sd_mm = read_contour_sd(table);
    p.drawn_by_slice = read_contour_style(table);
    read("displacement_sd_mm", {0, 1000, true}, p.displacement_sd_mm);
    read("displacement_range_mm", {0, 10000, true}, p.displacement_range_mm);
    read("stiffness_median_ratio", {1e-4, 1e4}, p.stiffness_median_ratio);
    read("stiffness_sd_ln", {0.01, 10}, p.stiffness_sd_ln);
    read("poisson_lowest", poisson_range, p.poisson_lowest);
    read("poisson_highest", poisson_range, p.poisson_highest);
    if (p.poisson_highest - p.poisson_lowest < narrowest_poisson_range - 1e-9)
        table.refuse(table.has("poisson_highest") ? "poisson_highest" : "poisson_lowest",
                     fmt::format("allowed: poisson_highest ({}) at least {} above poisson_lowest",
                                 p.poisson_highest, narrowest_poisson_range));
    return p;
}

void refuse_duplicates(const Settings& settings, const std::vector<SettingsTable>& tables) {
    for (std::size_t i = 0; i < settings.organs.size(); ++i) {
        const OrganSettings& organ = settings.organs[i];
        for (std::size_t j = 0; j < i; ++j) {
            if (organ.name == settings.organs[j].name)
                tables[i].refuse("name", "another organ has this name; names must differ");
            if (organ.label == settings.organs[j].label)
                tables[i].refuse("label", fmt::format("organ \"{}\" has this label; labels must "
                                                      "differ",
                                                      settings.organs[j].name));
        }
        if (settings.background && settings.background->label == organ.label)
            tables[i].refuse("label", "the background has this label; labels must differ");
    }
}

void require_meshed_and_reference(const Settings& settings, const SettingsTable& document) {
    bool meshed = settings.background.has_value(), known = meshed, unknown = false;
    for (const OrganSettings& organ : settings.organs) {
        if (organ.hollow) continue;
        meshed = true;
        (organ.stiffness_kpa ? known : unknown) = true;
    }
    if (!meshed)
        document.fail(
            "nothing to mesh: there is no [background] and every [[organ]] is hollow; "
            "add [background], or an organ with role = \"tissue\"");
    if (unknown && !known)
        document.fail(
            "no reference tissue: every stiffness_kpa is \"unknown\", but only ratios can "
            "be found; add [background] with stiffness_kpa, or give one organ a number");
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}

/// A float that TOML reads as one and that comes back bit by bit.
std::string number_text(double value) {
    std::string text = fmt::format("{}", value);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
}

template <typename Material>
std::string poisson_text(const Material& material) {
    return material.poisson_unknown ? "\"unknown\"" : number_text(material.poisson_ratio);
}

std::string organ_toml(const OrganSettings& organ) {
    std::string out = fmt::format("\n[[organ]]\nname = {}\nlabel = {}\nrole = \"{}\"\n",
                                  quoted(organ.name), organ.label, name_of(organ.role));
    if (organ.role != Role::tissue) out += fmt::format("hollow = {}\n", organ.hollow);
    if (organ.hollow) return out;
    out += "stiffness_kpa = ";
    out += organ.stiffness_kpa ? number_text(*organ.stiffness_kpa) : "\"unknown\"";
    return out + fmt::format("\npoisson_ratio = {}\n", poisson_text(organ));
}

std::string background_toml(const BackgroundSettings& background) {
    std::string out = "[background]\n";
    if (background.label) out += fmt::format("label = {}\n", *background.label);
    return out + fmt::format("stiffness_kpa = {}\npoisson_ratio = {}\nouter_boundary = \"{}\"\n",
                             number_text(background.stiffness_kpa), poisson_text(background),
                             background.outer_boundary_fixed ? "fixed" : "free");
}

std::string prior_toml(const PriorSettings& p, bool has_unknown_ratio) {
    std::string text = fmt::format(
        "\n[prior]\nnoise_voxels = {}\ncontour_sd_mm = {}\ncontour_style = "
        "\"{}\"\ndisplacement_sd_mm = {}\n"
        "displacement_range_mm = {}\nstiffness_median_ratio = {}\n"
        "stiffness_sd_ln = {}\n",
        number_text(p.noise_voxels),
        p.contour_sd_mm ? number_text(*p.contour_sd_mm) : "\"unknown\"", contour_style_name(p),
        number_text(p.displacement_sd_mm), number_text(p.displacement_range_mm),
        number_text(p.stiffness_median_ratio), number_text(p.stiffness_sd_ln));
    if (has_unknown_ratio)
        text += fmt::format("poisson_lowest = {}\npoisson_highest = {}\n",
                            number_text(p.poisson_lowest), number_text(p.poisson_highest));
    return text;
}

}  // namespace

const char* contour_style_name(const PriorSettings& prior) {
    if (!prior.drawn_by_slice) return "unknown";
    return *prior.drawn_by_slice ? "slices" : "surface";
}

const char* name_of(Role role) {
    switch (role) {
        case Role::tissue:
            return "tissue";
        case Role::driven:
            return "driven";
        case Role::fixed:
            return "fixed";
        case Role::background:
            return "background";
    }
    return "tissue";
}

bool Settings::has_unknown_poisson_ratio() const {
    return (background && background->poisson_unknown) ||
           std::any_of(organs.begin(), organs.end(),
                       [](const auto& organ) { return organ.poisson_unknown; });
}

Settings parse_settings(const std::string& toml, const std::string& source_name) {
    const SettingsTable document = SettingsTable::parse(toml, source_name);
    document.allow_keys({"background", "organ", "prior"});
    Settings settings;
    if (const auto table = document.table("background"))
        settings.background = read_background(*table);
    if (const auto table = document.table("prior")) settings.prior = read_prior(*table);
    const std::vector<SettingsTable> organs = document.tables("organ");
    if (organs.empty()) document.fail("there is no [[organ]]; describe at least one organ");
    for (const SettingsTable& table : organs) settings.organs.push_back(read_organ(table));
    refuse_duplicates(settings, organs);
    require_meshed_and_reference(settings, document);
    return settings;
}

Settings read_settings(const std::filesystem::path& path) {
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorCode::input_unreadable, path.string() + ": " + why);
    };
    if (!std::filesystem::exists(status)) refuse("no such settings file; check the path");
    if (!std::filesystem::is_regular_file(status)) refuse("not a file; give the settings in TOML");
    std::ifstream in(path, std::ios::binary);
    if (!in) refuse("cannot be opened; check its permissions");
    if (std::filesystem::file_size(path, failed) > largest_file_bytes)
        refuse("larger than 1 MiB, so it cannot be a settings file; give the settings in TOML");
    const std::string toml{std::istreambuf_iterator<char>(in), {}};
    return parse_settings(toml, path.filename().string());
}

std::string to_toml(const Settings& settings) {
    std::string out;
    if (settings.background) out += background_toml(*settings.background);
    for (const OrganSettings& organ : settings.organs) out += organ_toml(organ);
    return out + prior_toml(settings.prior, settings.has_unknown_poisson_ratio());
}

}  // namespace palpate
