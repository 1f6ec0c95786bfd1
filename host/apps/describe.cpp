// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/system/exit_codes.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const SettingValue& value) {
    return std::visit([](const auto& held) { return Json(held); }, value);
}

bool has_low(const Option& option) {
    return option.is_number() && option.range.low > any_number.low;
}
bool has_high(const Option& option) {
    return option.is_number() && option.range.high < any_number.high;
}

Json option_json(const Option& option) {
    Json json{{"name", option.name},
              {"kind", name_of(option.kind)},
              {"meaning", option.meaning},
              {"allowed", allowed_text(option)},
              {"default", option.usual ? value_json(*option.usual) : Json(nullptr)},
              {"required", option.is_required}};
    if (!option.unit.empty()) json["unit"] = option.unit;
    if (has_low(option)) json["minimum"] = option.range.low;
    if (has_high(option)) json["maximum"] = option.range.high;
    if (!option.choices.empty()) json["choices"] = option.choices;
    if (option.is_list()) {
        json["least_values"] = option.least;
        json["most_values"] = option.most < Option::any_count ? Json(option.most) : Json(nullptr);
    }
    if (!option.excluded.empty()) json["excludes"] = option.excluded;
    if (!option.needed.empty()) json["needs"] = option.needed;
    return json;
}

std::string usual_text(const Option& option) {
    if (option.is_required) return "required";
    if (!option.usual) return "";
    return fmt::format("`{}`", setting_text(*option.usual));
}

/// Bars would end a cell.
std::string cell(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '|') out += '\\';
        out += c;
    }
    return out;
}

// Boutiques

std::string in_capitals(std::string name) {
    for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return fmt::format("[{}]", name);
}

/// "time_limit" -> "Time limit".
std::string as_words(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    return name;
}

const char* boutiques_type(const Option& option) {
    if (option.kind == OptionKind::flag) return "Flag";
    if (option.is_number()) return "Number";
    return option.kind == OptionKind::input_file ? "File" : "String";
}

std::string description_of(const Option& option) {
    return option.unit.empty() ? option.meaning
                               : fmt::format("{} ({})", option.meaning, option.unit);
}

void add_limits(const Option& option, Json& input) {
    if (!option.is_number()) return;
    if (option.kind == OptionKind::integer) input["integer"] = true;
    if (has_low(option)) input["minimum"] = option.range.low;
    if (has_low(option) && option.range.open_low) input["exclusive-minimum"] = true;
    if (has_high(option)) input["maximum"] = option.range.high;
}

/// Whether it goes together with every other option: Boutiques hands defaults over as if they were
/// given.
bool is_free(const Option& option, const std::vector<Option>& all) {
    const auto names_it = [&](const Option& other) {
        return std::find(other.excluded.begin(), other.excluded.end(), option.name) !=
               other.excluded.end();
    };
    return option.excluded.empty() && option.needed.empty() &&
           std::none_of(all.begin(), all.end(), names_it);
}

Json input_json(const Option& option, const std::vector<Option>& all) {
    Json input{{"id", option.name},
               {"name", as_words(option.name)},
               {"description", description_of(option)},
               {"type", boutiques_type(option)},
               {"value-key", in_capitals(option.name)}};
    if (!option.is_required) input["optional"] = true;
    if (!option.is_positional) input["command-line-flag"] = command_line_name(option.name);
    add_limits(option, input);
    if (!option.choices.empty()) input["value-choices"] = option.choices;
    if (option.is_list() && !option.is_repeated()) {  // Boutiques cannot repeat a flag
        input["list"] = true;
        input["min-list-entries"] = option.least;
        if (option.most < Option::any_count) input["max-list-entries"] = option.most;
    }
    if (option.usual && option.kind != OptionKind::flag && is_free(option, all))
        input["default-value"] = value_json(*option.usual);
    if (!option.excluded.empty()) input["disables-inputs"] = option.excluded;
    for (const std::string& name : option.needed)
        if (find_option(all, name)) input["requires-inputs"].push_back(name);
    return input;
}

Json exit_codes_json() {
    Json list = Json::array();
    for (const auto& [code, meaning] : exit_codes())
        if (code != 0) list.push_back({{"code", code}, {"description", meaning}});
    return list;
}

}  // namespace

std::string applications_json(const std::vector<Application>& all) {
    Json list = Json::array();
    for (const Application& application : all) {
        Json options = Json::array();
        for (const Option& option : all_options(application))
            options.push_back(option_json(option));
        list.push_back({{"name", application.name},
                        {"summary", application.summary},
                        {"options", std::move(options)}});
    }
    return Json{{"applications", std::move(list)}}.dump(2) + "\n";
}

std::string applications_markdown(const std::vector<Application>& all) {
    std::string page =
        "# Applications and their options\n\n"
        "Made by `palpate describe --as markdown`. An option is called the same everywhere: "
        "`time_limit` is `--time-limit` on the\ncommand line, a key of the settings text in "
        "[C](c.md), and a keyword in [Python](python.md).\n";
    for (const Application& application : all) {
        page += fmt::format(
            "\n## {}\n\n{}.\n\n| option | allowed | default | meaning |\n"
            "| --- | --- | --- | --- |\n",
            application.name, application.summary);
        for (const Option& option : all_options(application))
            page +=
                fmt::format("| `{}` | {} | {} | {} |\n", option.name, cell(allowed_text(option)),
                            cell(usual_text(option)), cell(option.meaning));
    }
    return page;
}

std::string boutiques_json(const Application& application) {
    const std::vector<Option> options = all_options(application);
    std::string command = fmt::format("palpate {}", application.name);
    Json inputs = Json::array();
    for (const Option& option : options) {
        command += ' ' + in_capitals(option.name);
        inputs.push_back(input_json(option, options));
    }
    const std::string version = version_text();
    Json json{{"name", fmt::format("palpate {}", application.name)},
              {"description", application.summary + ". Not a medical device."},
              {"author", "The palpate developers"},
              {"tool-version", version.substr(0, version.find(' '))},
              {"schema-version", "0.5"},
              {"command-line", command},
              {"inputs", std::move(inputs)},
              {"output-files",
               {{{"id", "result"},
                 {"name", "Result folder"},
                 {"description", find_option(options, "out")->meaning},
                 {"path-template", in_capitals("out")},
                 {"optional", true}}}},
              {"error-codes", exit_codes_json()},
              {"tags", {{"domain", {"biomechanics", "elastography", "medical imaging"}}}}};
    return json.dump(4) + "\n";
}

}  // namespace palpate
