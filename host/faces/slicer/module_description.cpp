// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/slicer/module_description.hpp"

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <sstream>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Tree = boost::property_tree::ptree;

std::vector<std::string> split_at_commas(const std::string& text) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

std::optional<double> number_at(const Tree& node, const char* path) {
    const auto found = node.get_optional<double>(path);
    return found ? std::optional(*found) : std::nullopt;
}

ModuleParameter parameter_of(const std::string& type, const std::string& group, const Tree& node) {
    ModuleParameter parameter;
    parameter.group = group;
    parameter.type = type;
    parameter.name = node.get<std::string>("name");
    parameter.description = node.get<std::string>("description");
    parameter.long_flag = node.get("longflag", "");
    if (const auto index = node.get_optional<int>("index")) parameter.index = *index;
    parameter.default_value = node.get("default", "");
    parameter.is_output = node.get("channel", "input") == "output";
    parameter.minimum = number_at(node, "constraints.minimum");
    parameter.maximum = number_at(node, "constraints.maximum");
    parameter.file_extensions = split_at_commas(node.get("<xmlattr>.fileExtensions", ""));
    for (const auto& [tag, child] : node)
        if (tag == "element") parameter.choices.push_back(child.data());
    return parameter;
}

/// Of one group of parameters, which begins with texts about itself.
void add_parameters(const Tree& group, std::vector<ModuleParameter>& parameters) {
    for (const auto& [tag, node] : group)
        if (tag != "label" && tag != "description" && tag != "<xmlattr>" && tag != "<xmlcomment>")
            parameters.push_back(parameter_of(tag, group.get<std::string>("label"), node));
}

}  // namespace

bool ModuleDescription::has(const std::string& name) const {
    return std::ranges::find(parameters, name, &ModuleParameter::name) != parameters.end();
}

const ModuleParameter& ModuleDescription::at(const std::string& name) const {
    for (const ModuleParameter& parameter : parameters)
        if (parameter.name == name) return parameter;
    throw Error(ErrorCode::internal, "the module has no parameter '" + name + "'");
}

ModuleDescription parse_module_description(const std::string& xml) {
    try {
        Tree root;
        std::istringstream stream(xml);
        boost::property_tree::read_xml(stream, root,
                                       boost::property_tree::xml_parser::trim_whitespace);
        const Tree& executable = root.get_child("executable");
        ModuleDescription module;
        module.title = executable.get<std::string>("title");
        module.description = executable.get<std::string>("description");
        module.version = executable.get<std::string>("version");
        for (const auto& [tag, group] : executable)
            if (tag == "parameters") add_parameters(group, module.parameters);
        return module;
    } catch (const boost::property_tree::ptree_error& error) {
        throw Error(ErrorCode::internal,
                    std::string("the description of the module is damaged: ") + error.what());
    }
}

}  // namespace palpate
