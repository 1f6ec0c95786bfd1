// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/patient_events.hpp"

#include <array>
#include <nlohmann/json.hpp>

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::array<const char*, 4> words_of_events{"started", "done", "failed", "patient failed"};

}  // namespace

std::string event_line(const PatientEvent& event) {
    Json json{{"event", words_of_events.at(static_cast<std::size_t>(event.kind))},
              {"case", event.case_id},
              {"code", event.code},
              {"sentence", event.sentence}};
    if (event.record) json["record"] = record_line(*event.record);
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<PatientEvent> event_of(const std::string& line) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    try {
        for (std::size_t k = 0; k < words_of_events.size(); ++k) {
            if (json.at("event") != words_of_events[k]) continue;
            PatientEvent event{static_cast<PatientEvent::Kind>(k), json.at("case"), json.at("code"),
                               json.at("sentence")};
            if (json.contains("record"))
                event.record = record_of(json["record"].get<std::string>());
            return event;
        }
    } catch (const Json::exception&) {
    }
    return std::nullopt;
}

}  // namespace palpate
