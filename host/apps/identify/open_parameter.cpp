// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/open_parameter.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

struct Typical {
    std::string_view key;
    double median = 0, sd = 0;  ///< 0: nothing is known
};

/// Numbers that are no parameter of a law; of soft tissue and glass or steel.
constexpr Typical of_amplitude{"amplitude", 0.5, 1.0}, of_time{"time_s", 3.0, 1.5},
    of_friction{"friction", 0.3, 1.0};

/// By where a number stands as well: other tables have keys of the same name.
Typical typical_of(const OpenNumber& number) {
    const std::string& key = number.key;
    if (number.path.starts_with("obstacle[") && key == of_friction.key) return of_friction;
    if (!number.path.starts_with("material[")) return {key};
    if (number.path.find("].relaxation[") != number.path.npos)
        return key == of_amplitude.key ? of_amplitude : of_time;
    for (const MaterialDescription& law : material_laws())
        for (const MaterialParameter& parameter : law.parameters)
            if (parameter.name == key) return {key, parameter.typical, parameter.typical_sd};
    return {key};
}

/// What is given in advance or not at all: how a model is solved, and what is noise.
bool must_be_given(const OpenNumber& number) {
    const std::string& key = number.key;
    return number.path.starts_with("newton.") || number.path.starts_with("dynamics.") ||
           key == "longest_step_s" || key == "sd" || key.starts_with("sd_") ||
           key.starts_with("correlation_");
}

/// By the end of a key's name, as everywhere: "mu_kpa" is in kPa.
std::string unit_of(const std::string& key) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> units{
        {{"_kpa_per_mm", "kPa/mm"},
         {"_mn_per_mm", "mN/mm"},
         {"_per_kpa", "1/kPa"},
         {"_per_s", "1/s"},
         {"kpa", "kPa"},
         {"_mm", "mm"},
         {"_mn", "mN"},
         {"_s", "s"}}};
    for (const auto& [end, unit] : units)
        if (key.size() >= end.size() && key.ends_with(end)) return std::string(unit);
    return "";
}

Transform transform_of(const OpenNumber& number) {
    const bool has_low = number.range.low > any_number.low;
    const bool has_high = number.range.high < any_number.high;
    if (!number.is_unknown) return number.sd_ln ? Transform::log : Transform::identity;
    if (has_low && has_high) return Transform::logit;
    if (has_low && number.range.low == 0) return Transform::log;
    return number.sd_ln ? Transform::log : Transform::identity;
}

[[noreturn]] void refuse(const OpenNumber& number, const std::string& why) {
    throw Error(ErrorCode::invalid_argument, fmt::format("'{}' is open: {}", number.path, why));
}

void take_prior(const OpenNumber& number, Parameter& parameter) {
    const Typical typical = typical_of(number);
    if (number.median)
        parameter.median = *number.median;
    else if (typical.sd > 0)
        parameter.median = typical.median;
    else if (number.start)
        parameter.median = *number.start;
    else
        refuse(number, "nothing is known of such a number beforehand; give it a start or a median");
    const auto given_sd = number.sd_ln ? number.sd_ln : number.sd;
    if (number.sd && parameter.transform != Transform::identity && !number.sd_ln)
        refuse(number, "its logarithm is looked for; give sd_ln in place of sd");
    if (given_sd)
        parameter.sd = *given_sd;
    else if (typical.sd > 0)
        parameter.sd = typical.sd;
    parameter.start = number.start.value_or(parameter.median);
}

}  // namespace

Parameter parameter_of(const OpenNumber& number) {
    if (must_be_given(number)) refuse(number, "it has to be given; write a number");
    const std::size_t dot = number.path.rfind('.');
    Parameter parameter{
        .name = dot == std::string::npos ? number.path : number.path.substr(dot + 1),
        .object = number.path.substr(0, dot == std::string::npos ? 0 : dot),
        .unit = unit_of(number.key)};
    parameter.transform = transform_of(number);
    if (number.range.low > any_number.low) parameter.lowest = number.range.low;
    if (number.range.high < any_number.high) parameter.highest = number.range.high;
    if (number.is_unknown) {
        take_prior(number, parameter);
    } else {
        parameter.start = parameter.median = number.value;
        parameter.sd = number.sd_ln ? *number.sd_ln : *number.sd;
        parameter.is_nuisance = true;
        parameter.is_held = number.is_held;
    }
    if (number.lowest) parameter.lowest = *number.lowest;
    if (number.highest) parameter.highest = *number.highest;
    return parameter;
}

}  // namespace palpate
