// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/gallery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "host/cohort/gallery_assets.hpp"
#include "host/cohort/ratings.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"
#include "host/page/page.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t cards_a_page = 200, cards_a_file = 5000;
constexpr double slow_times_median = 3;

Json number_json(double value) {
    return std::isfinite(value) ? Json(std::stod(fmt::format("{:.4g}", value))) : Json();
}

/// What gallery.js knows as a region: name, verdict, E and the ends of its interval.
Json gallery_region(const RegionRecord& region) {
    return Json::array({region.region, region.verdict, number_json(region.e_kpa),
                        number_json(region.e_low_kpa), number_json(region.e_high_kpa)});
}

std::string dumped(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string file_of_rows(std::size_t number) { return fmt::format("rows-{:04}.js", number); }

}  // namespace

std::size_t Gallery::add(const CohortFolder& folder, const CohortPatient& patient,
                         const CohortCase& c, const CaseState& state, CaseFlags flags,
                         const std::string& rating) {
    Json regions = Json::array();
    double seconds = 0;
    if (state.record) {
        seconds = state.record->seconds;
        for (const RegionRecord& region : state.record->regions) {
            regions.push_back(gallery_region(region));
            if (!std::isfinite(region.e_kpa) || !(region.e_low_kpa > 0)) continue;
            low_kpa_ = low_kpa_ > 0 ? std::min(low_kpa_, region.e_low_kpa) : region.e_low_kpa;
            high_kpa_ = std::max(high_kpa_, region.e_high_kpa);
        }
    }
    const std::string place =
        folder.case_folder(patient, c).lexically_relative(folder.path() / "cases").string();
    const std::string key = state.record ? state.record->key : c.key;
    Json row =
        Json::array({place, c.target_name, c.session_id, key.substr(0, short_key_digits), rating,
                     regions, number_json(seconds), state.failure ? state.failure->sentence : ""});
    std::string text = dumped(row);
    text.pop_back();  // flags follow at the end
    cases_.push_back(
        {rows_.size(), static_cast<std::uint32_t>(text.size()), float(seconds), flags});
    rows_ += text;
    return cases_.size() - 1;
}

void Gallery::sort() {
    std::vector<float> seconds;
    for (const Case& c : cases_)
        if (c.seconds > 0) seconds.push_back(c.seconds);
    if (!seconds.empty()) {
        const auto middle = seconds.begin() + std::ptrdiff_t(seconds.size() / 2);
        std::nth_element(seconds.begin(), middle, seconds.end());
        for (Case& c : cases_)
            if (c.seconds > slow_times_median * *middle) c.flags.add(CaseFlag::slow);
    }
    order_.resize(cases_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::vector<int> bad;
    for (const Case& c : cases_) bad.push_back(badness(c.flags));
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return bad[a] > bad[b]; });
    place_.resize(cases_.size());
    for (std::size_t k = 0; k < order_.size(); ++k)
        place_[order_[k]] = static_cast<std::uint32_t>(k + 1);
}

std::vector<std::size_t> Gallery::flag_counts() const {
    std::vector<std::size_t> counts(num_case_flags, 0);
    for (const Case& c : cases_)
        for (std::size_t k = 0; k < num_case_flags; ++k)
            counts[k] += c.flags.has(static_cast<CaseFlag>(k));
    return counts;
}

std::string Gallery::chunk_text(std::size_t first) const {
    std::string text = fmt::format("galleryRows({},[\n", first / cards_a_file);
    for (std::size_t k = first; k < std::min(first + cards_a_file, order_.size()); ++k) {
        const Case& c = cases_[order_[k]];
        text += row_of(c);
        text += fmt::format(",{}],\n", c.flags.bits());
    }
    return text + "]);\n";
}

void Gallery::write(const std::filesystem::path& cohort,
                    const std::vector<std::pair<std::string, std::string>>& more) const {
    write_folder_atomically(cohort / "gallery", true, [&](const std::filesystem::path& inside) {
        for (std::size_t first = 0; first < std::max<std::size_t>(order_.size(), 1);
             first += cards_a_file)
            write_text_file(inside / file_of_rows(first / cards_a_file), chunk_text(first));
        for (const auto& [name, text] : more) write_text_file(inside / name, text);
    });
    Json flags = Json::array();
    for (std::size_t k = 0; k < num_case_flags; ++k)
        flags.push_back(name_of(static_cast<CaseFlag>(k)));
    const Json head{{"cases", cases_.size()},        {"page", cards_a_page},
                    {"file", cards_a_file},          {"flags", flags},
                    {"counts", flag_counts()},       {"low", number_json(low_kpa_)},
                    {"high", number_json(high_kpa_)}};
    replace_text(
        cohort / "gallery.html",
        page_html({.kind = "Gallery of a cohort",
                   .version = version_text(),
                   .headline = fmt::format("{} cases, the worst first", grouped(cases_.size())),
                   .lead = std::string(gallery_help_html()),
                   .main = std::string(gallery_body_html()),
                   .style = std::string(gallery_css()),
                   .scripts = fmt::format("const GALLERY = {};\n{}", script_json(dumped(head)),
                                          gallery_js()),
                   .takes_files_beside = true}));
}

}  // namespace palpate
