// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/slicer/module_arguments.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& sentence) {
    throw Error(ErrorCode::invalid_argument, sentence);
}

std::string called(const ModuleParameter& parameter) {
    return parameter.long_flag.empty() ? parameter.name : fmt::format("--{}", parameter.long_flag);
}

template <class Number>
Number number_of(const ModuleParameter& parameter, const std::string& text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        refuse(fmt::format("{}: '{}' is not a{} number", called(parameter), text,
                           std::is_integral_v<Number> ? " whole" : ""));
    if ((parameter.minimum && value < *parameter.minimum) ||
        (parameter.maximum && value > *parameter.maximum))
        refuse(fmt::format("{}: {} lies outside {} to {}", called(parameter), text,
                           *parameter.minimum, *parameter.maximum));
    return value;
}

template <class Number>
std::vector<Number> numbers_of(const ModuleParameter& parameter, const std::string& text) {
    std::vector<Number> values;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');)
        values.push_back(number_of<Number>(parameter, part));
    return values;
}

void check_ending(const ModuleParameter& parameter, const std::string& path) {
    if (parameter.file_extensions.empty() || path.empty()) return;
    for (const std::string& ending : parameter.file_extensions)
        if (path.ends_with(ending)) return;
    refuse(fmt::format("{}: '{}' must end in {}", called(parameter), path,
                       parameter.file_extensions.front()));
}

void check_value(const ModuleParameter& parameter, const std::string& value) {
    if (parameter.type == "integer") number_of<int>(parameter, value);
    if (parameter.type == "double") number_of<double>(parameter, value);
    if (parameter.type == "integer-vector") numbers_of<int>(parameter, value);
    if (parameter.type == "boolean" && value != "true" && value != "false")
        refuse(fmt::format("{}: '{}' is neither true nor false", called(parameter), value));
    if (!parameter.choices.empty() &&
        std::ranges::find(parameter.choices, value) == parameter.choices.end())
        refuse(fmt::format("{}: there is no '{}'", called(parameter), value));
    check_ending(parameter, value);
}

/// The text of a JSON value: lists become commas.
std::string text_of(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump();
    std::string text;
    for (const Json& part : value)
        text += fmt::format("{}{}", text.empty() ? "" : ",", part.dump());
    return text;
}

/// A checked value as JSON holds it.
Json typed(const ModuleParameter& parameter, const std::string& text) {
    if (parameter.type == "boolean") return text == "true";
    if (parameter.type == "integer") return number_of<int>(parameter, text);
    if (parameter.type == "double") return number_of<double>(parameter, text);
    if (parameter.type == "integer-vector") return numbers_of<int>(parameter, text);
    return text;
}

constexpr std::uintmax_t largest_file = 1 << 20;

/// By name.
std::map<std::string, std::string> values_of_file(const ModuleDescription& module,
                                                  const std::string& path) {
    std::error_code failed;
    const auto size = std::filesystem::file_size(path, failed);
    if (failed || size > largest_file)
        throw Error(ErrorCode::input_unreadable, path + ": no file of parameters below a megabyte");
    std::ifstream file(path);
    const Json json = Json::parse(file, nullptr, false);
    const auto parameters = json.find("Parameters");
    if (!json.is_object() || parameters == json.end() || !parameters->is_object())
        throw Error(ErrorCode::input_unreadable, path + ": holds no \"Parameters\" in JSON");
    std::map<std::string, std::string> values;
    for (const auto& [label, group] : parameters->items()) {
        if (!group.is_object()) refuse(fmt::format("{}: '{}' is no group", path, label));
        for (const auto& [name, value] : group.items()) {
            if (!module.has(name))
                refuse(fmt::format("{}: there is no parameter '{}'", path, name));
            if (!module.at(name).is_returned()) values[name] = text_of(value);
        }
    }
    return values;
}

/// Walks along the arguments.
class Reader {
public:
    Reader(const ModuleDescription& module, const std::vector<std::string>& words)
        : module_(module), words_(words) {}

    ModuleArguments read() {
        while (next_ < words_.size()) read_word(words_[next_++]);
        arguments_.values.merge(values_of_file_);  // what was given on the command line stays
        for (const ModuleParameter& parameter : module_.parameters)
            arguments_.values.emplace(parameter.name, parameter.default_value);
        return arguments_;
    }

private:
    void read_word(const std::string& word) {
        if (!word.starts_with("--")) return take_positional(word);
        const auto equals = word.find('=');
        const std::string flag = word.substr(2, equals == word.npos ? word.npos : equals - 2);
        if (equals != word.npos) given_ = word.substr(equals + 1);
        take_flag(flag);
        if (given_) refuse(fmt::format("--{} takes no value", flag));
    }

    void take_flag(const std::string& flag) {
        if (flag == "xml")
            arguments_.wants_xml = true;
        else if (flag == "help")
            arguments_.wants_help = true;
        else if (flag == "version")
            arguments_.wants_version = true;
        else if (flag == "echo")
            arguments_.wants_echo = true;
        else if (flag == "returnparameterfile")
            arguments_.return_parameter_file = value_of(flag);
        else if (flag == "processinformationaddress")
            value_of(flag);  // of shared libraries only
        else if (flag == "serialize")
            arguments_.serialize_to = value_of(flag);
        else if (flag == "deserialize")
            values_of_file_ = values_of_file(module_, value_of(flag));
        else
            take_parameter(flag);
    }

    void take_parameter(const std::string& flag) {
        for (const ModuleParameter& parameter : module_.parameters)
            if (!flag.empty() && parameter.long_flag == flag) {
                const bool is_bare = parameter.type == "boolean";
                arguments_.values[parameter.name] = is_bare ? "true" : value_of(flag);
                return;
            }
        refuse(fmt::format("there is no --{}; see --help", flag));
    }

    void take_positional(const std::string& word) {
        for (const ModuleParameter& parameter : module_.parameters)
            if (parameter.index == num_positional_) {
                arguments_.values[parameter.name] = word;
                ++num_positional_;
                return;
            }
        refuse(fmt::format("'{}' is one argument too many; see --help", word));
    }

    std::string value_of(const std::string& flag) {
        if (given_) return *std::exchange(given_, std::nullopt);
        if (next_ == words_.size()) refuse(fmt::format("--{} needs a value", flag));
        return words_[next_++];
    }

    const ModuleDescription& module_;
    const std::vector<std::string>& words_;
    std::size_t next_ = 0;
    int num_positional_ = 0;
    std::optional<std::string> given_;  ///< behind the = of the word being read
    std::map<std::string, std::string> values_of_file_;
    ModuleArguments arguments_;
};

}  // namespace

double ModuleArguments::number(const std::string& name) const { return std::stod(values.at(name)); }

std::vector<int> ModuleArguments::integers(const std::string& name) const {
    return numbers_of<int>({}, values.at(name));
}

ModuleArguments parse_module_arguments(const ModuleDescription& module,
                                       const std::vector<std::string>& words) {
    ModuleArguments arguments = Reader(module, words).read();
    if (arguments.wants_xml || arguments.wants_help || arguments.wants_version) return arguments;
    for (const ModuleParameter& parameter : module.parameters) {
        const std::string& value = arguments.values.at(parameter.name);
        if (parameter.index && value.empty())
            refuse(fmt::format("the {} is missing; see --help", parameter.name));
        if (!parameter.is_returned()) check_value(parameter, value);
    }
    return arguments;
}

std::string to_json(const ModuleDescription& module, const ModuleArguments& arguments) {
    Json values = Json::object();
    for (const ModuleParameter& parameter : module.parameters)
        if (!parameter.is_returned())
            values[parameter.group][parameter.name] =
                typed(parameter, arguments.text(parameter.name));
    return Json{{"Parameters", values}}.dump(2) + "\n";
}

std::string help_text(const ModuleDescription& module) {
    std::string text =
        fmt::format("{}\n\nUSAGE: palpate-slicer [flags] reference target\n\n", module.description);
    for (const ModuleParameter& parameter : module.parameters)
        if (!parameter.is_returned())
            text += fmt::format("  {:<16} {}{}\n", called(parameter), parameter.description,
                                parameter.default_value.empty()
                                    ? ""
                                    : " (default: " + parameter.default_value + ")");
    return text +
           "\n  --xml --help --version --echo --returnparameterfile FILE --serialize FILE\n"
           "  --deserialize FILE: as every module of 3D Slicer has them\n";
}

std::string echo_text(const ModuleDescription& module, const ModuleArguments& arguments) {
    std::string text = "Command line arguments\n";
    for (const ModuleParameter& parameter : module.parameters)
        if (!parameter.is_returned())
            text += fmt::format("    {}: {}\n", parameter.name, arguments.text(parameter.name));
    return text;
}

}  // namespace palpate
