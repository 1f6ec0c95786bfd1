// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/slicer/table_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "host/io/option_values.hpp"
#include "host/page/markup.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

const char* type_of(const Option& option) {
    switch (option.kind) {
        case OptionKind::flag:
            return "boolean";
        case OptionKind::integer:
            return "integer";
        case OptionKind::number:
            return "double";
        case OptionKind::choice:
            return "string-enumeration";
        case OptionKind::text:
            return "string";
        default:
            throw Error(ErrorCode::internal, option.name + " is no plain value");
    }
}

/// "mesh_time_limit" in s -> "Mesh time limit (s)".
std::string label_of(const Option& option) {
    std::string label = option.name;
    std::replace(label.begin(), label.end(), '_', ' ');
    label.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(label.front())));
    return option.unit.empty() ? label : fmt::format("{} ({})", label, option.unit);
}

std::string default_of(const Option& option) {
    if (!option.usual) return "";
    const auto* text = std::get_if<std::string>(&*option.usual);
    return text ? *text : setting_text(*option.usual);
}

std::string constraints_of(const Option& option) {
    if (!option.is_number()) return "";
    return fmt::format("<constraints><minimum>{}</minimum><maximum>{}</maximum></constraints>\n",
                       option.range.low, option.range.high);
}

}  // namespace

std::string parameters_xml(const std::vector<Option>& options) {
    std::string xml;
    for (const Option& option : options) {
        xml += fmt::format(
            "<{}>\n<name>{}</name>\n<label>{}</label>\n<longflag>{}</longflag>\n"
            "<description>{}</description>\n<default>{}</default>\n",
            type_of(option), option.name, escape_html(label_of(option)),
            command_line_name(option.name).substr(2), escape_html(option.meaning),
            escape_html(default_of(option)));
        for (const std::string& choice : option.choices)
            xml += fmt::format("<element>{}</element>\n", escape_html(choice));
        xml += constraints_of(option) + fmt::format("</{}>\n", type_of(option));
    }
    return xml;
}

}  // namespace palpate
