// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/combination.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double least_told_coefficient = 0.1;
/// Wider relative errors are told as factors.
constexpr double max_told_percent = 50.0;

/// The spread with which a parameter is scaled.
double scale_of(const Parameter& parameter, double value) {
    if (parameter.has_prior()) return parameter.sd;
    if (parameter.transform != Transform::identity) return 1.0;
    return value != 0 ? std::abs(value) : 1.0;
}

std::string power(const std::string& label, double exponent) {
    return std::abs(exponent - 1.0) < 0.005 ? label : fmt::format("{}^{:.2g}", label, exponent);
}

/// "mu * gamma^0.3 / c^0.5" of logs, whose coefficients are exponents.
std::string product_words(const std::vector<Parameter>& parameters, const Eigen::VectorXd& a) {
    std::string above, below;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const double exponent = a[static_cast<Index>(k)];
        if (std::abs(exponent) < least_told_coefficient) continue;
        std::string& side = exponent > 0 ? above : below;
        side += (exponent > 0 ? (above.empty() ? "" : " * ") : " / ") +
                power(label_of(parameters[k]), std::abs(exponent));
    }
    return (above.empty() ? "1" : above) + below;
}

std::string term_words(const Parameter& parameter) {
    if (parameter.transform == Transform::identity) return label_of(parameter);
    return fmt::format("{}({})", parameter.transform == Transform::log ? "ln" : "logit",
                       label_of(parameter));
}

/// "ln(mu) - 3.2 delay_s" where not all are logs.
std::string sum_words(const std::vector<Parameter>& parameters, const Eigen::VectorXd& a,
                      const Eigen::VectorXd& scales) {
    std::string words;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const double factor = a[static_cast<Index>(k)];
        if (std::abs(factor * scales[static_cast<Index>(k)]) <
            least_told_coefficient * a.cwiseProduct(scales).lpNorm<Eigen::Infinity>())
            continue;
        const char* sign =
            factor < 0 ? (words.empty() ? "-" : " - ") : (words.empty() ? "" : " + ");
        words += sign;
        if (std::abs(std::abs(factor) - 1.0) >= 0.005)
            words += fmt::format("{:.2g} ", std::abs(factor));
        words += term_words(parameters[k]);
    }
    return words;
}

std::string knowledge_words(bool is_product, double sd) {
    const double reach = 1.96 * sd;
    if (!is_product) return fmt::format("is known to +-{:.2g}", reach);
    // A factor of exp(reach) to either side
    const double percent = 100.0 * std::expm1(reach);
    if (percent <= max_told_percent) return fmt::format("is known to {:.2g} %", percent);
    return fmt::format("is known only to a factor of {:.2g}", std::exp(reach));
}

}  // namespace

ScaledSensitivity prior_scaled_sensitivity(const std::vector<Parameter>& parameters,
                                           const Eigen::VectorXd& values,
                                           const Eigen::MatrixXd& information) {
    std::vector<Unknown> unknowns;
    for (std::size_t k = 0; k < parameters.size(); ++k)
        unknowns.push_back(
            {static_cast<Index>(k), 0, scale_of(parameters[k], values[static_cast<Index>(k)])});
    return scaled_sensitivity(information, unknowns);
}

Combination combination_of(const std::vector<Parameter>& parameters, const Eigen::VectorXd& values,
                           const Eigen::MatrixXd& covariance, const ScaledSensitivity& sensitivity,
                           Eigen::Index which) {
    Combination combination;
    combination.singular_value = sensitivity.singular_values[which];
    Eigen::VectorXd scales(values.size());
    for (Eigen::Index k = 0; k < scales.size(); ++k) scales[k] = scale_of(parameters[k], values[k]);
    // sum_k d_k (t_k / scale_k), normalised so that the largest d_k has the coefficient 1.
    Eigen::Index largest = 0;
    sensitivity.directions.col(which).cwiseAbs().maxCoeff(&largest);
    Eigen::VectorXd a = sensitivity.directions.col(which).cwiseQuotient(scales);
    a /= a[largest];
    combination.coefficients = a;
    combination.sd = std::sqrt(a.dot(covariance * a));
    const bool is_product =
        std::all_of(parameters.begin(), parameters.end(),
                    [](const Parameter& p) { return p.transform == Transform::log; });
    combination.words =
        (is_product ? product_words(parameters, a) : sum_words(parameters, a, scales)) + " " +
        knowledge_words(is_product, combination.sd);
    return combination;
}

}  // namespace palpate
