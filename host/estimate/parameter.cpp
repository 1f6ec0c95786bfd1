// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/parameter.hpp"

#include <fmt/core.h>

#include <cmath>
#include <set>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuse_parameter(const Parameter& parameter, const std::string& what) {
    throw Error(ErrorCode::invalid_argument, fmt::format("{}: {}", label_of(parameter), what));
}

void check_size(const std::vector<Parameter>& parameters, const Eigen::VectorXd& vector) {
    if (vector.size() != static_cast<Eigen::Index>(parameters.size()))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("{} numbers were given for {} parameters", vector.size(),
                                parameters.size()));
}

template <typename Function>
Eigen::VectorXd each(const std::vector<Parameter>& parameters, const Eigen::VectorXd& vector,
                     Function function) {
    check_size(parameters, vector);
    Eigen::VectorXd result(vector.size());
    for (Eigen::Index k = 0; k < vector.size(); ++k) result[k] = function(parameters[k], vector[k]);
    return result;
}

void check_number(const Parameter& parameter, double value, const char* which) {
    if (!std::isfinite(value))
        refuse_parameter(parameter, fmt::format("its {} is no finite number", which));
    if (value < parameter.lowest || value > parameter.highest)
        refuse_parameter(parameter, fmt::format("its {}, {:g}, is not between {:g} and {:g}", which,
                                                value, parameter.lowest, parameter.highest));
    to_transformed(parameter, value);
}

void check_parameter(const Parameter& parameter) {
    if (parameter.name.empty()) throw Error(ErrorCode::invalid_argument, "a parameter has no name");
    if (!(parameter.lowest < parameter.highest))
        refuse_parameter(parameter,
                         fmt::format("its lowest value, {:g}, is not below its highest, {:g}",
                                     parameter.lowest, parameter.highest));
    if (parameter.transform == Transform::logit &&
        !(std::isfinite(parameter.lowest) && std::isfinite(parameter.highest)))
        refuse_parameter(parameter, "a logit needs a lowest and a highest value");
    if (!(parameter.sd > 0))
        refuse_parameter(parameter,
                         fmt::format("the sd of its prior, {:g}, is not above 0", parameter.sd));
    if (parameter.is_held &&
        !(parameter.is_nuisance && parameter.has_prior() && parameter.start == parameter.median))
        refuse_parameter(parameter,
                         "what is held is a nuisance with a prior and stays at its median");
    check_number(parameter, parameter.start, "start");
    if (parameter.has_prior()) check_number(parameter, parameter.median, "prior's median");
}

/// An end of the range on the transformed scale.
double transformed_end(const Parameter& parameter, double end) {
    if (parameter.transform == Transform::logit)
        return std::copysign(std::numeric_limits<double>::infinity(), end - parameter.start);
    if (parameter.transform == Transform::identity) return end;
    return end > 0 ? std::log(end) : -std::numeric_limits<double>::infinity();
}

}  // namespace

const char* name_of(Transform transform) {
    switch (transform) {
        case Transform::identity:
            return "identity";
        case Transform::log:
            return "log";
        case Transform::logit:
            return "logit";
    }
    return "identity";
}

std::string label_of(const Parameter& parameter) {
    if (!parameter.words.empty()) return parameter.words;
    if (parameter.object.empty()) return parameter.name;
    return fmt::format("{} of {}", parameter.name, parameter.object);
}

double to_transformed(const Parameter& parameter, double value) {
    switch (parameter.transform) {
        case Transform::identity:
            return value;
        case Transform::log:
            if (!(value > 0))
                refuse_parameter(parameter, fmt::format("{:g} has no logarithm; give a value above "
                                                        "0 or search it on its own scale",
                                                        value));
            return std::log(value);
        case Transform::logit:
            if (!(value > parameter.lowest && value < parameter.highest))
                refuse_parameter(parameter,
                                 fmt::format("{:g} is not strictly between {:g} and {:g}", value,
                                             parameter.lowest, parameter.highest));
            return std::log((value - parameter.lowest) / (parameter.highest - value));
    }
    return value;
}

double to_value(const Parameter& parameter, double transformed) {
    switch (parameter.transform) {
        case Transform::identity:
            return transformed;
        case Transform::log:
            return std::exp(transformed);
        case Transform::logit: {
            // Either end exactly where t is large: lowest + range / (1 + e^-t) loses the upper one.
            const double range = parameter.highest - parameter.lowest;
            const double share = 1.0 / (1.0 + std::exp(std::abs(transformed)));
            return transformed > 0 ? parameter.highest - range * share
                                   : parameter.lowest + range * share;
        }
    }
    return transformed;
}

double slope_of(const Parameter& parameter, double transformed) {
    switch (parameter.transform) {
        case Transform::identity:
            return 1.0;
        case Transform::log:
            return std::exp(transformed);
        case Transform::logit: {
            // (v - lowest) (highest - v) / (highest - lowest) = range q (1 - q)
            const double share = 1.0 / (1.0 + std::exp(std::abs(transformed)));
            return (parameter.highest - parameter.lowest) * share * (1.0 - share);
        }
    }
    return 1.0;
}

Eigen::VectorXd to_transformed(const std::vector<Parameter>& parameters,
                               const Eigen::VectorXd& values) {
    return each(parameters, values,
                [](const Parameter& p, double value) { return to_transformed(p, value); });
}

Eigen::VectorXd to_values(const std::vector<Parameter>& parameters,
                          const Eigen::VectorXd& transformed) {
    return each(parameters, transformed,
                [](const Parameter& p, double t) { return to_value(p, t); });
}

Eigen::VectorXd slopes_of(const std::vector<Parameter>& parameters,
                          const Eigen::VectorXd& transformed) {
    return each(parameters, transformed,
                [](const Parameter& p, double t) { return slope_of(p, t); });
}

std::vector<Index> held_of(const std::vector<Parameter>& parameters) {
    std::vector<Index> held;
    for (std::size_t k = 0; k < parameters.size(); ++k)
        if (parameters[k].is_held) held.push_back(static_cast<Index>(k));
    return held;
}

Eigen::VectorXd starts_of(const std::vector<Parameter>& parameters) {
    Eigen::VectorXd starts(parameters.size());
    for (std::size_t k = 0; k < parameters.size(); ++k) starts[k] = parameters[k].start;
    return starts;
}

TransformedRange range_of(const std::vector<Parameter>& parameters) {
    TransformedRange range{Eigen::VectorXd(parameters.size()), Eigen::VectorXd(parameters.size())};
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        range.lower[k] = transformed_end(parameters[k], parameters[k].lowest);
        range.upper[k] = transformed_end(parameters[k], parameters[k].highest);
    }
    return range;
}

double TransformedPriors::energy(const Eigen::VectorXd& transformed) const {
    return 0.5 * (transformed - mean).cwiseAbs2().dot(precision);
}

TransformedPriors priors_of(const std::vector<Parameter>& parameters) {
    TransformedPriors priors{Eigen::VectorXd(parameters.size()),
                             Eigen::VectorXd::Zero(parameters.size())};
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const Parameter& parameter = parameters[k];
        const bool has_prior = parameter.has_prior();
        priors.mean[k] = to_transformed(parameter, has_prior ? parameter.median : parameter.start);
        if (has_prior) priors.precision[k] = 1.0 / (parameter.sd * parameter.sd);
    }
    return priors;
}

void check_parameters(const std::vector<Parameter>& parameters) {
    if (parameters.empty())
        throw Error(ErrorCode::invalid_argument, "no number is unknown: there is nothing to fit");
    std::set<std::pair<std::string, std::string>> names;
    for (const Parameter& parameter : parameters) {
        check_parameter(parameter);
        if (!names.emplace(parameter.object, parameter.name).second)
            refuse_parameter(parameter, "it is there twice");
    }
}

}  // namespace palpate
