// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/case_record.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/cohort/content_key.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* record_format = "palpate-cohort-case";
constexpr auto replace_bad_text = Json::error_handler_t::replace;

/// The numbers of a region by their names in the file.
constexpr std::pair<const char*, double RegionRecord::*> region_numbers[] = {
    {"e_kpa", &RegionRecord::e_kpa},         {"sd_ln", &RegionRecord::sd_ln},
    {"e_low_kpa", &RegionRecord::e_low_kpa}, {"e_high_kpa", &RegionRecord::e_high_kpa},
    {"ln_e_data", &RegionRecord::ln_e_data}, {"sd_data", &RegionRecord::sd_data},
    {"dice", &RegionRecord::dice},           {"mean_distance_mm", &RegionRecord::mean_distance_mm}};

double number_in(const Json& json, const char* name) {
    const auto found = json.find(name);
    return found != json.end() && found->is_number() ? found->get<double>() : RegionRecord::none;
}

Json flags_json(CaseFlags flags) {
    Json names = Json::array();
    for (std::size_t k = 0; k < num_case_flags; ++k)
        if (flags.has(static_cast<CaseFlag>(k))) names.push_back(name_of(static_cast<CaseFlag>(k)));
    return names;
}

CaseFlags flags_of(const Json& names) {
    CaseFlags flags;
    for (const Json& name : names)
        if (const auto flag = case_flag_of(name.get<std::string>())) flags.add(*flag);
    return flags;
}

Json region_json(const RegionRecord& region) {
    Json json{{"region", region.region}, {"verdict", region.verdict}};
    for (const auto& [name, member] : region_numbers)
        json[name] = std::isfinite(region.*member) ? Json(region.*member) : Json(nullptr);
    return json;
}

RegionRecord region_of(const Json& json) {
    RegionRecord region{json.at("region"), json.at("verdict")};
    for (const auto& [name, member] : region_numbers) region.*member = number_in(json, name);
    return region;
}

}  // namespace

std::string record_line(const CaseRecord& r) {
    Json json{{"format", record_format},
              {"format_version", 1},
              {"version", r.version},
              {"numerics_version", numerics_version},
              {"patient", r.patient},
              {"case", r.case_id},
              {"key", r.key},
              {"converged", r.converged},
              {"contour_sd_mm", std::isfinite(r.contour_sd_mm) ? Json(r.contour_sd_mm) : Json()},
              {"seconds", r.seconds},
              {"peak_memory_mb", r.peak_memory_mb},
              {"device", r.device},
              {"host", r.host},
              {"mesh", r.mesh},
              {"flags", flags_json(r.flags)},
              {"regions", Json::array()}};
    for (const RegionRecord& region : r.regions) json["regions"].push_back(region_json(region));
    return json.dump(-1, ' ', false, replace_bad_text);
}

std::optional<CaseRecord> record_of(const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    try {
        if (json.at("format") != record_format) return std::nullopt;
        CaseRecord r{json.at("patient"), json.at("case"), json.at("key"), json.at("version")};
        r.converged = json.at("converged");
        r.contour_sd_mm = number_in(json, "contour_sd_mm");
        r.seconds = json.at("seconds");
        r.peak_memory_mb = json.at("peak_memory_mb");
        r.device = json.at("device");
        r.host = json.at("host");
        r.mesh = json.at("mesh");
        r.flags = flags_of(json.at("flags"));
        for (const Json& region : json.at("regions")) r.regions.push_back(region_of(region));
        return r;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

void take_prior_out(RegionRecord& region, double prior_median_kpa, double prior_sd_ln) {
    const double precision = 1 / (region.sd_ln * region.sd_ln);
    const double prior_precision = 1 / (prior_sd_ln * prior_sd_ln);
    if (!(precision > prior_precision) || !std::isfinite(precision)) return;
    const double variance = 1 / (precision - prior_precision);
    region.sd_data = std::sqrt(variance);
    region.ln_e_data = variance * (std::log(region.e_kpa) * precision -
                                   std::log(prior_median_kpa) * prior_precision);
}

std::string failure_text(const FailureRecord& f) {
    return Json{{"key", f.key},           {"code", f.code}, {"sentence", f.sentence},
                {"attempts", f.attempts}, {"host", f.host}, {"log_tail", f.log_tail}}
               .dump(2, ' ', false, replace_bad_text) +
           "\n";
}

std::optional<FailureRecord> failure_of(const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    try {
        return FailureRecord{json.at("key"),      json.at("sentence"), json.at("host"),
                             json.at("log_tail"), json.at("code"),     json.at("attempts")};
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

}  // namespace palpate
