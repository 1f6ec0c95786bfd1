// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/recover_choice.hpp"

#include <algorithm>
#include <set>

#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/apps/recover/run/recover_table.hpp"
#include "host/cohort/cohort_plan.hpp"
#include "host/cohort/content_key.hpp"

namespace palpate {
namespace {

/// What the table, the plan or the folder of a cohort says.
const std::set<std::string> of_one_call = {"reference",
                                           "target",
                                           "config",
                                           "out",
                                           "overwrite",
                                           "initial_transform",
                                           "repeated_reference",
                                           "plan",
                                           "plan_motion",
                                           "plan_contours",
                                           "target_surface",
                                           "target_points",
                                           "target_frame",
                                           "target_noise",
                                           "reference_image",
                                           "target_image",
                                           "landmarks",
                                           "landmarks_ras",
                                           "fields",
                                           "keep_file_names",
                                           "mesh",
                                           "save_reduced",
                                           "load_reduced"};

/// Who computes, how and how fast: the answer is the same.
const std::set<std::string> no_part_of_the_key = {
    "backend", "device",          "precision",         "linear_solver", "factorisation",
    "product", "mesh_time_limit", "mesh_memory_limit", "mesh_program"};

}  // namespace

std::vector<Option> cohort_recover_table() {
    std::vector<Option> table;
    for (const Option& option : recover_table())
        if (!of_one_call.count(option.name)) table.push_back(option);
    return table;
}

OptionValues recover_values(const std::string& recover_toml, const std::string& align) {
    std::vector<Option> table = recover_table();
    for (Option& option : table) option.is_required = false;  // the plan has them
    std::string text = recover_toml;
    if (!align.empty()) {
        const std::size_t old = text.find("align = ");
        if (old != std::string::npos) text.erase(old, text.find('\n', old) + 1 - old);
        text += "align = \"" + align + "\"\n";
    }
    return OptionValues::from_settings(table, text, "cohort.toml");
}

std::map<std::string, std::string> options_of_the_key(const OptionValues& values) {
    std::map<std::string, std::string> options;
    for (const Option& option : cohort_recover_table()) {
        if (no_part_of_the_key.count(option.name)) continue;
        const auto value = values.setting(option.name);
        options[option.name] = value ? setting_text(*value) : "";
    }
    if (!tissue_law_of(values.text("material")).is_linear())
        options["large_deformation_version"] = std::to_string(large_deformation_version);
    return options;
}

}  // namespace palpate
