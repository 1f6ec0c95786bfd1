// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/pipeline/recover.hpp"
#include "host/faces/slicer/module_arguments.hpp"
#include "host/io/option.hpp"

namespace palpate {

/// Of the settings file, or of the lists of labels. Organs of a list are called tissue-1, driven-2.
/// Throws Error(invalid_argument): neither a file nor any label, a label in two lists.
Settings module_settings(const ModuleArguments& arguments);

/// The options of `palpate recover` that the module has, too.
std::vector<Option> method_options();

/// What is computed. Throws Error, also for outputs that could not be written.
RecoverOptions module_options(const ModuleArguments& arguments);

/// Throws Error(output_failed) if an output that was asked for could not be written.
void check_module_outputs(const ModuleArguments& arguments);

/// Writes what was asked for, each file and folder all or nothing. Outputs of a module replace what
/// is there: its host names temporary files. Throws Error(output_failed) and leaves none of them.
void write_module_outputs(const ModuleArguments& arguments, const RecoveryResult& result);

/// `name = value` a line: what a host shows beside the module.
std::string return_parameters(const RecoveryResult& result);

}  // namespace palpate
