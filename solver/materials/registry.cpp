// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/materials/registry.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

template <class... Laws>
std::vector<MaterialDescription> descriptions(const std::tuple<Laws...>*) {
    return {Laws::description()...};
}

/// "above 0", "0 or more and below 0.5"
std::string range_text(const ParameterRange& range) {
    const bool has_lowest = range.lowest > -std::numeric_limits<double>::infinity();
    const bool has_highest = range.highest < std::numeric_limits<double>::infinity();
    std::string text;
    if (has_lowest)
        text = range.includes_lowest ? fmt::format("{} or more", range.lowest)
                                     : fmt::format("above {}", range.lowest);
    if (has_lowest && has_highest) text += " and ";
    if (has_highest)
        text += range.includes_highest ? fmt::format("at most {}", range.highest)
                                       : fmt::format("below {}", range.highest);
    return text.empty() ? "any number" : text;
}

}  // namespace

const std::vector<MaterialDescription>& material_laws() {
    static const auto laws = descriptions(static_cast<MaterialLaws<double>*>(nullptr));
    return laws;
}

const MaterialDescription& material_law(std::string_view name) {
    std::string known;
    for (const MaterialDescription& law : material_laws()) {
        if (law.name == name) return law;
        known += (known.empty() ? "" : ", ") + std::string(law.name);
    }
    throw Error(ErrorCode::invalid_argument,
                fmt::format("There is no material law \"{}\"; choose one of: {}.", name, known));
}

std::string allowed_text(const MaterialParameter& parameter) {
    return fmt::format("{}{}{} ({})", range_text(parameter.range), parameter.unit == "1" ? "" : " ",
                       parameter.unit == "1" ? "" : parameter.unit, parameter.meaning);
}

void check_parameters(const MaterialDescription& law, std::span<const double> values) {
    if (values.size() != law.parameters.size())
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("The material law {} has {} parameters, but {} values were given.",
                                law.name, law.parameters.size(), values.size()));
    for (std::size_t k = 0; k < values.size(); ++k) {
        const MaterialParameter& parameter = law.parameters[k];
        if (!parameter.range.contains(values[k]))
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("The material law {} has {} = {}, which must be {}.", law.name,
                                    parameter.name, values[k], allowed_text(parameter)));
    }
}

SmallStrainModuli small_strain_moduli(std::string_view name, std::span<const double> values) {
    SmallStrainModuli moduli;
    with_material_law<double>(name, values,
                              [&](const auto& law) { moduli = law.small_strain(values.data()); });
    return moduli;
}

std::vector<double> parameters_of_moduli(std::string_view name, const SmallStrainModuli& moduli) {
    std::vector<double> values;
    [&]<class... Laws>(const std::tuple<Laws...>*) {
        ((Laws::description().name == name ? void(values = Laws::parameters_of(moduli)) : void()),
         ...);
    }(static_cast<MaterialLaws<double>*>(nullptr));
    check_parameters(material_law(name), values);
    return values;
}

std::vector<double> parameters_of_stiffness(std::string_view name, std::span<const double> values,
                                            double stiffness_kpa) {
    const MaterialDescription& law = material_law(name);
    const double factor = stiffness_kpa / small_strain_moduli(name, values).stiffness_kpa;
    std::vector<double> scaled(values.begin(), values.end());
    // Every energy is a sum of terms that are linear in a parameter in kPa, or in 1 / one in 1/kPa.
    for (std::size_t k = 0; k < scaled.size(); ++k) {
        if (law.parameters[k].unit == "kPa") scaled[k] *= factor;
        if (law.parameters[k].unit == "1/kPa") scaled[k] /= factor;
    }
    return scaled;
}

std::vector<double> material_coefficients(std::string_view name, std::span<const double> values) {
    std::vector<double> coefficients;
    with_material_law<double>(name, values, [&](const auto& law) {
        const auto members = std::bit_cast<std::array<double, sizeof law / sizeof(double)>>(law);
        coefficients.assign(members.begin(), members.end());
    });
    return coefficients;
}

}  // namespace palpate
