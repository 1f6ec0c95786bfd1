// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/faces/slicer/module_description.hpp"

namespace palpate {

/// The command line of a module: the flags that every module has, and a checked value for each
/// parameter of its description.
struct ModuleArguments {
    bool wants_xml = false, wants_help = false, wants_version = false, wants_echo = false;
    std::string return_parameter_file;
    std::string serialize_to;
    std::map<std::string, std::string> values;  ///< by name; defaults where none was given

    const std::string& text(const std::string& name) const { return values.at(name); }
    double number(const std::string& name) const;
    bool flag(const std::string& name) const { return values.at(name) == "true"; }
    /// Of numbers separated by commas.
    std::vector<int> integers(const std::string& name) const;
};

/// `arguments` without the program's name. Values of a `--deserialize` file are taken first.
/// Throws Error(invalid_argument): unknown flag, missing value or input, no number, out of range,
/// none of the choices, another file ending; Error(input_unreadable) for a `--deserialize` file.
ModuleArguments parse_module_arguments(const ModuleDescription& module,
                                       const std::vector<std::string>& arguments);

/// The values as JSON, {"Parameters": {group: {name: value}}}, as `--serialize` writes and
/// `--deserialize` reads them.
std::string to_json(const ModuleDescription& module, const ModuleArguments& arguments);

/// What `--help` and `--echo` print.
std::string help_text(const ModuleDescription& module);
std::string echo_text(const ModuleDescription& module, const ModuleArguments& arguments);

}  // namespace palpate
