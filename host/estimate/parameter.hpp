// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "host/estimate/objective.hpp"

namespace palpate {

/// The scale t on which a parameter v is searched and on which its prior is Gaussian.
enum class Transform : std::uint8_t {
    identity,  ///< t = v
    log,       ///< t = ln v
    logit,     ///< t = ln((v - lowest) / (highest - v))
};

/// The words of files and pages: "identity", "log", "logit".
const char* name_of(Transform transform);

/// One number that an estimate looks for. Nothing here knows whether it is a modulus, a relaxation
/// time or a friction.
struct Parameter {
    std::string name;    ///< its kind, as settings call it: "c1_kpa"
    std::string object;  ///< what it belongs to: a tissue, an instrument; may be empty
    std::string unit;    ///< of the value: "kPa"; empty: a plain number
    Transform transform = Transform::identity;
    double start = 0;  ///< where a search begins, on the parameter's own scale
    /// The prior: its median on the parameter's own scale, and its standard deviation on the
    /// transformed scale (sd of ln v for log). Infinite: flat on the transformed scale.
    double median = 0;
    double sd = std::numeric_limits<double>::infinity();
    /// Values that are allowed, on the parameter's own scale. For logit the ends of its scale,
    /// which are never reached; for the others hard ends of the search.
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    bool is_nuisance = false;  ///< estimated and integrated out: reported, but not asked for
    /// It stays at its median, whatever the data say, and what its prior leaves unknown of it joins
    /// what is unknown of the others (`normal_equations`).
    bool is_held = false;
    std::string words = {};  ///< what people call it; empty: as `label_of` puts it together

    bool has_prior() const { return sd < std::numeric_limits<double>::infinity(); }
};

/// Its words, or else "c1_kpa of liver", or the name alone where there is no object.
std::string label_of(const Parameter& parameter);

/// t of a value. Throws Error(invalid_argument), naming parameter, value and range, where the value
/// has none: not above 0 for log, not strictly between the ends for logit.
double to_transformed(const Parameter& parameter, double value);
/// The value of t; the inverse of `to_transformed`.
double to_value(const Parameter& parameter, double transformed);
/// dv/dt at t: 1, v, or (v - lowest) (highest - v) / (highest - lowest).
double slope_of(const Parameter& parameter, double transformed);

/// The same for all of them; vectors are [num_parameter]. Throws Error(invalid_argument) if the
/// sizes differ.
Eigen::VectorXd to_transformed(const std::vector<Parameter>& parameters,
                               const Eigen::VectorXd& values);
Eigen::VectorXd to_values(const std::vector<Parameter>& parameters,
                          const Eigen::VectorXd& transformed);
Eigen::VectorXd slopes_of(const std::vector<Parameter>& parameters,
                          const Eigen::VectorXd& transformed);

/// Which are held.
std::vector<Index> held_of(const std::vector<Parameter>& parameters);

/// Where a search begins, [num_parameter] on the parameters' own scales.
Eigen::VectorXd starts_of(const std::vector<Parameter>& parameters);

/// Hard ends of the transformed scales, [num_parameter] each; infinite where there are none.
struct TransformedRange {
    Eigen::VectorXd lower, upper;
};
TransformedRange range_of(const std::vector<Parameter>& parameters);

/// The prior precisions 1 / sd^2 and the medians on the transformed scale, [num_parameter] each. A
/// flat prior has precision 0 and the start as its median.
struct TransformedPriors {
    Eigen::VectorXd mean, precision;
    /// Sum of (t - mean)^2 / sd^2 / 2: the priors' part of minus the log posterior.
    double energy(const Eigen::VectorXd& transformed) const;
};
TransformedPriors priors_of(const std::vector<Parameter>& parameters);

/// Throws Error(invalid_argument) unless the parameters make sense: names that differ within an
/// object, numbers that are finite where they must be, sd above 0, lowest < highest, start and
/// median within.
void check_parameters(const std::vector<Parameter>& parameters);

}  // namespace palpate
