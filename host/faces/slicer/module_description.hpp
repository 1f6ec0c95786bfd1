// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// One parameter of a module of 3D Slicer's execution model.
struct ModuleParameter {
    std::string type;  ///< "image", "double", "integer-vector", "string-enumeration", ...
    std::string name;
    std::string group;  ///< label of the group it is shown in
    std::string description;
    std::string long_flag;     ///< without dashes; empty for positional and returned ones
    std::optional<int> index;  ///< position among the arguments without a flag
    std::string default_value;
    bool is_output = false;
    std::vector<std::string> choices;          ///< of an enumeration
    std::optional<double> minimum, maximum;    ///< of a number
    std::vector<std::string> file_extensions;  ///< with dots; empty: any

    /// A value that comes back in the return parameter file and not by an argument.
    bool is_returned() const { return is_output && long_flag.empty() && !index; }
};

/// What the XML description of a module says. Host programs and our own command line both read it;
/// the options of the method in it are made from the table of `palpate recover`.
struct ModuleDescription {
    std::string title, description, version;
    std::vector<ModuleParameter> parameters;

    bool has(const std::string& name) const;
    /// Throws Error(internal) for an unknown name.
    const ModuleParameter& at(const std::string& name) const;
};

/// Throws Error(internal) if the text is no description.
ModuleDescription parse_module_description(const std::string& xml);

}  // namespace palpate
