// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/model/aspiration_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>

#include "host/apps/aspirate/model/calibration.hpp"
#include "host/io/files.hpp"
#include "host/io/number_table.hpp"
#include "host/io/settings_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr NumberRange length_mm{0, 200, true}, pixel_um{0, 10000, true}, pixels{0, 20000};
constexpr double hole_radii_deep = 4, hole_radii_wide = 4;
constexpr int most_terms = 3;

/// Reads numbers that may be known with an error; what is open where that is not meant is refused.
class NumberReader {
public:
    OpenNumbers resolver() const {
        return [last = last_](const OpenNumber& number) {
            if (!last->is_allowed)
                throw Error(ErrorCode::invalid_argument,
                            fmt::format("'{}' has to be given; write a number", number.path));
            last->number = number;
            return number.is_unknown ? number.start.value_or(1) : number.value;
        };
    }

    std::optional<SettingNumber> read(const SettingsTable& table, const char* key,
                                      NumberRange range, bool may_be_unknown = false) const {
        last_->is_allowed = true;
        last_->number.reset();
        const auto value = table.number(key, range);
        last_->is_allowed = false;
        if (!value) return std::nullopt;
        SettingNumber number{*value};
        if (!last_->number) return number;
        if (last_->number->is_unknown && !may_be_unknown)
            table.refuse(key, "allowed: a number, or {value = ..., sd = ...}");
        if (!last_->number->is_unknown && !last_->number->sd)
            table.refuse(key, "allowed beside a value: its sd");
        number.sd = last_->number->sd;
        number.is_unknown = last_->number->is_unknown;
        return number;
    }

private:
    struct Last {
        bool is_allowed = false;
        std::optional<OpenNumber> number;
    };
    std::shared_ptr<Last> last_ = std::make_shared<Last>();
};

double needed(const SettingsTable& table, const char* key, NumberRange range, const char* example) {
    const auto value = table.number(key, range);
    if (!value) table.missing(key, example);
    return *value;
}

SettingNumber needed(const std::optional<SettingNumber>& number, const SettingsTable& table,
                     const char* key, const char* example) {
    if (!number) table.missing(key, example);
    return *number;
}

std::array<Index, 4> read_crop(const SettingsTable& table) {
    const char* allowed = "allowed: left column, top row, width and height in whole pixels";
    const auto numbers = *table.numbers("crop_px", 4, 4);
    std::array<Index, 4> crop{};
    for (std::size_t k = 0; k < 4; ++k) {
        if (!(numbers[k] >= (k < 2 ? 0 : 1)) || !pixels.contains(numbers[k]) ||
            numbers[k] != std::round(numbers[k]))
            table.refuse("crop_px", allowed);
        crop[k] = Index(numbers[k]);
    }
    return crop;
}

void read_camera(const SettingsTable& table, const fs::path& folder, AspirationSettings& read,
                 const NumberReader& reader, bool is_needed) {
    AspirationInstrument& instrument = read.instrument;
    if (table.has("calibration")) {
        for (const char* key : {"pixel_z_um", "base_row_px"})
            if (table.has(key)) table.refuse(key, "it comes from 'calibration'; give one of both");
        const TipCalibration found = read_calibration(folder / *table.text("calibration"));
        read.pixel_z_um = found.pixel_z_um;
        instrument.base_row_px = found.base_row_px;
    } else if (is_needed || table.has("pixel_z_um")) {
        read.pixel_z_um = needed(reader.read(table, "pixel_z_um", pixel_um), table, "pixel_z_um",
                                 "31.75, for example");
    }
    if (is_needed || table.has("pixel_r_um"))
        read.pixel_r_um = needed(reader.read(table, "pixel_r_um", pixel_um), table, "pixel_r_um",
                                 "62.9, for example");
    if (!table.has("calibration") && (is_needed || table.has("base_row_px")))
        instrument.base_row_px = needed(table, "base_row_px", pixels, "150, for example");
    instrument.axis_column_px = table.number("axis_column_px", pixels);
    if (table.has("crop_px")) {
        instrument.crop_px = read_crop(table);
        instrument.base_row_px -= double((*instrument.crop_px)[1]);
        if (instrument.axis_column_px)
            *instrument.axis_column_px -= double((*instrument.crop_px)[0]);
    }
    if (const auto tissue = table.choice("tissue", {"brighter", "darker"}))
        instrument.is_brighter = *tissue == "brighter";
    instrument.pixel_r_um = read.pixel_r_um.value;
    instrument.pixel_z_um = read.pixel_z_um.value;
}

void read_instrument(const SettingsTable& table, const fs::path& folder, AspirationSettings& read,
                     const NumberReader& reader, AspirationPart part) {
    table.allow_keys({"hole_diameter_mm", "edge_radius_mm", "rim_thickness_mm", "outer_diameter_mm",
                      "pixel_r_um", "pixel_z_um", "calibration", "base_row_px", "axis_column_px",
                      "crop_px", "tissue"});
    read.hole_diameter_mm = needed(reader.read(table, "hole_diameter_mm", length_mm), table,
                                   "hole_diameter_mm", "10.0, for example");
    read.instrument.hole_diameter_mm = read.hole_diameter_mm.value;
    read.instrument.rim_thickness_mm =
        needed(table, "rim_thickness_mm", {0, 50}, "0.5, for example");
    const auto edge = reader.read(table, "edge_radius_mm", length_mm);
    if (part == AspirationPart::tissue || part == AspirationPart::both)
        read.edge_radius_mm = needed(edge, table, "edge_radius_mm",
                                     "0.2, or {value = 0.2, sd = 0.05} where it is not exact");
    read.outer_diameter_mm =
        table.number("outer_diameter_mm", length_mm).value_or(2 * read.hole_diameter_mm.value);
    const double least = read.hole_diameter_mm.value + 4 * read.edge_radius_mm.value;
    if (edge && !(read.outer_diameter_mm > least))
        table.refuse("outer_diameter_mm",
                     fmt::format("allowed: more than hole and rounded edges, {:g} mm", least));
    read_camera(table, folder, read, reader, part != AspirationPart::tissue);
}

/// The table of times is read only if there are frames to be timed.
void read_frames(const SettingsTable& table, const fs::path& folder, AspirationInstrument& read,
                 bool is_needed) {
    table.allow_keys({"rate_hz", "times", "method"});
    if (const auto method = table.choice("method", {"path", "published"}))
        read.is_published = *method == "published";
    if (const auto file = table.text("times")) {
        if (table.has("rate_hz")) table.refuse("times", "give either times or rate_hz");
        if (!is_needed) return;
        const NumberTable times = read_number_table(folder / *file);
        read.frame_time_s = times.values("time_s");
        for (std::size_t k = 1; k < read.frame_time_s.size(); ++k)
            if (!(read.frame_time_s[k] > read.frame_time_s[k - 1]))
                throw Error(ErrorCode::input_unusable,
                            fmt::format("{}, line {}: times of frames must ascend", times.source,
                                        times.lines[k]));
    } else {
        read.rate_hz = table.number("rate_hz", {0, 1e6, true}).value_or(0);
    }
}

std::vector<std::string> read_laws(const SettingsTable& table) {
    const std::vector<std::string> known{"neo-hookean-reduced", "veronda-westmann",
                                         "reduced-polynomial"};
    const auto value = table.value("laws");
    if (!value) return {"veronda-westmann"};
    const auto* names = std::get_if<std::vector<std::string>>(&*value);
    const auto is_known = [&](const std::string& name) {
        return std::find(known.begin(), known.end(), name) != known.end();
    };
    const auto is_twice = [&](const std::string& name) {
        return std::count(names->begin(), names->end(), name) > 1;
    };
    if (!names || names->empty() || !std::all_of(names->begin(), names->end(), is_known))
        table.refuse("laws", fmt::format("allowed: a list of some of {}", fmt::join(known, ", ")));
    if (std::any_of(names->begin(), names->end(), is_twice))
        table.refuse("laws", "a law stands there twice");
    return *names;
}

std::vector<int> read_terms(const SettingsTable& table) {
    const auto numbers = table.numbers("relaxation_terms", 1, most_terms + 1);
    if (!numbers) return {1};
    std::vector<int> terms;
    for (const double number : *numbers) {
        if (!(number >= 0 && number <= most_terms) || number != std::round(number))
            table.refuse("relaxation_terms", "allowed: a list of some of 0, 1, 2, 3");
        if (std::find(terms.begin(), terms.end(), int(number)) != terms.end())
            table.refuse("relaxation_terms", fmt::format("{} stands there twice", number));
        terms.push_back(int(number));
    }
    return terms;
}

void read_tissue(const SettingsTable& table, AspirationSettings& read, const NumberReader& reader) {
    table.allow_keys({"depth_mm", "width_mm", "side", "laws", "relaxation_terms",
                      "kappa_over_young", "friction", "steps", "refine"});
    if (const auto depth = reader.read(table, "depth_mm", length_mm)) read.depth_mm = *depth;
    read.width_mm = table.number("width_mm", length_mm).value_or(read.width_mm);
    if (read.width_mm < 0.6 * read.outer_diameter_mm)
        table.refuse("width_mm", fmt::format("allowed: at least {:g}, beyond the tube",
                                             0.6 * read.outer_diameter_mm));
    const std::string side = table.choice("side", {"slides", "held", "free"}).value_or("slides");
    read.side = side == "held"   ? TissueSide::held
                : side == "free" ? TissueSide::free
                                 : TissueSide::slides;
    read.laws = read_laws(table);
    read.relaxation_terms = read_terms(table);
    read.kappa_over_young =
        table.number("kappa_over_young", {10, 1e6}).value_or(read.kappa_over_young);
    read.sticks = table.is_text("friction", "stick");
    if (read.sticks)
        read.friction = {stick_friction};
    else if (const auto friction = reader.read(table, "friction", {0, stick_friction}, true))
        read.friction = *friction;
    read.steps = table.whole_number("steps", 12, 400).value_or(read.steps);
    read.refine = table.whole_number("refine", 1, 4).value_or(read.refine);
}

SupposedTissue read_supposed(const SettingsTable& table) {
    table.allow_keys({"mu_kpa", "gamma", "amplitude", "time_s", "cap_mm", "sd_mm"});
    SupposedTissue read;
    read.mu_kpa = needed(table, "mu_kpa", {0, 1e4, true}, "0.7, for example");
    read.gamma = table.number("gamma", {0, 200}).value_or(read.gamma);
    read.amplitude = table.number("amplitude", {0, 100, true}).value_or(read.amplitude);
    read.relaxation_s = table.number("time_s", {0, 1e4, true}).value_or(read.relaxation_s);
    read.cap_mm = table.number("cap_mm", {0, 50}).value_or(read.cap_mm);
    read.sd_mm = table.number("sd_mm", {0, 10, true}).value_or(read.sd_mm);
    return read;
}

}  // namespace

ContourSettings AspirationInstrument::contours(Index width, Index height) const {
    const double visible = visible_row();
    if (base_row_px >= double(height) || visible < 24)
        throw Error(
            ErrorCode::input_unusable,
            fmt::format("nothing can be seen above the line of visibility: base_row_px is {:g} "
                        "and the rim hides rows from {:.0f} on, in frames of {} rows; correct "
                        "base_row_px, rim_thickness_mm or pixel_z_um",
                        base_row_px, visible, height));
    return {width, height, visible, is_brighter};
}

double AspirationInstrument::time_s(Index frame) const {
    if (frame_time_s.empty()) return double(frame) / rate_hz;
    if (frame >= Index(frame_time_s.size()))
        throw Error(ErrorCode::input_unusable,
                    fmt::format("there are times for {} frames, but more frames; give a time for "
                                "each",
                                frame_time_s.size()));
    return frame_time_s[std::size_t(frame)];
}

AspirationSettings parse_aspiration_settings(const std::string& text, const std::string& name,
                                             const fs::path& folder, AspirationPart part) {
    const NumberReader reader;
    const SettingsTable all = SettingsTable::parse(text, name, reader.resolver());
    all.allow_keys({"instrument", "frames", "pressure", "tissue", "supposed"});
    AspirationSettings read;
    read.text = text;
    const auto instrument = all.table("instrument"), frames = all.table("frames");
    if (!instrument) all.missing("instrument", "a table [instrument]");
    read_instrument(*instrument, folder, read, reader, part);
    if (frames)
        read_frames(*frames, folder, read.instrument,
                    part == AspirationPart::frames || part == AspirationPart::both);
    if (const auto pressure = all.table("pressure")) {
        pressure->allow_keys({"delay_s", "time_s", "suction_mbar", "suction_kpa"});
        if (const auto delay = reader.read(*pressure, "delay_s", {-10, 10})) read.delay_s = *delay;
        read.suction = suction_of(*pressure);
    }
    read.depth_mm = {0.5 * hole_radii_deep * read.hole_diameter_mm.value};
    read.width_mm =
        std::max(0.5 * hole_radii_wide * read.hole_diameter_mm.value, read.outer_diameter_mm);
    read.laws = {"veronda-westmann"};
    read.relaxation_terms = {1};
    if (const auto tissue = all.table("tissue")) read_tissue(*tissue, read, reader);
    if (const auto supposed = all.table("supposed")) read.supposed = read_supposed(*supposed);
    return read;
}

AspirationSettings read_aspiration_settings(const fs::path& path, AspirationPart part) {
    if (const auto why = why_unreadable(path))
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("cannot read '{}': {}; check the path", path.string(), *why));
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    return parse_aspiration_settings(text, path.filename().string(), path.parent_path(), part);
}

}  // namespace palpate
