// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/parameter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

Parameter friction() {
    Parameter parameter = flat_parameter("friction", 0.5);
    parameter.object = "rim";
    parameter.transform = Transform::logit;
    parameter.lowest = 0.2;
    parameter.highest = 1.4;
    return parameter;
}

std::string refusal(const std::vector<Parameter>& parameters) {
    try {
        check_parameters(parameters);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "";
}

TEST(Parameter, TransformsGoThereAndBackAndSlopesAreTheirDerivatives) {
    constexpr double h = 1e-6;
    for (const Parameter& parameter :
         {flat_parameter("x", 0.7), log_parameter("mu", 0.7, 1, 1), friction()}) {
        for (const double value : {0.25, 0.7, 1.3}) {
            const double t = to_transformed(parameter, value);
            const double difference =
                (to_value(parameter, t + h) - to_value(parameter, t - h)) / (2 * h);

            EXPECT_NEAR(to_value(parameter, t), value, 1e-14) << name_of(parameter.transform);
            EXPECT_NEAR(slope_of(parameter, t), difference, 1e-9) << name_of(parameter.transform);
        }
    }
    EXPECT_EQ(to_transformed(log_parameter("mu", 1, 1, 1), std::exp(2.0)), 2.0);
    EXPECT_NEAR(to_transformed(friction(), 0.8), 0.0, 1e-15);
}

TEST(Parameter, ALogitNeverReachesItsEndsFromInside) {
    EXPECT_NEAR(to_value(friction(), 30), 1.4, 1e-12);
    EXPECT_NEAR(to_value(friction(), -30), 0.2, 1e-12);
    EXPECT_GT(to_value(friction(), 30), 1.39999);
    EXPECT_GT(slope_of(friction(), 300), -1e-300);
    EXPECT_EQ(range_of({friction()}).upper[0], std::numeric_limits<double>::infinity());
}

TEST(Parameter, PriorsAreGaussianOnTheTransformedScale) {
    const std::vector<Parameter> parameters{log_parameter("mu", 1, 2, 0.5), flat_parameter("x", 3)};
    const TransformedPriors priors = priors_of(parameters);

    EXPECT_DOUBLE_EQ(priors.mean[0], std::log(2.0));
    EXPECT_EQ(priors.precision[0], 4.0);
    EXPECT_EQ(priors.precision[1], 0.0);
    EXPECT_DOUBLE_EQ(priors.energy(Eigen::Vector2d(std::log(2.0) + 0.5, 99)), 0.5);
}

TEST(Parameter, WhatMakesNoSenseIsRefusedByName) {
    Parameter bad = log_parameter("mu", -1, 1, 1);
    bad.object = "liver";
    EXPECT_NE(refusal({bad}).find("mu of liver"), std::string::npos) << refusal({bad});
    EXPECT_NE(refusal({}), "");
    EXPECT_NE(refusal({flat_parameter("x", 1), flat_parameter("x", 2)}).find("twice"),
              std::string::npos);
    bad = friction();
    bad.start = 1.4;
    EXPECT_NE(refusal({bad}).find("strictly between"), std::string::npos) << refusal({bad});
    bad.highest = std::numeric_limits<double>::infinity();
    EXPECT_NE(refusal({bad}).find("logit needs"), std::string::npos) << refusal({bad});
    bad = log_parameter("mu", 1, 1, 0);
    EXPECT_NE(refusal({bad}).find("sd of its prior"), std::string::npos);
    bad = log_parameter("mu", 5, 1, 1);
    bad.highest = 2;
    EXPECT_NE(refusal({bad}).find("not between"), std::string::npos) << refusal({bad});
}

}  // namespace
}  // namespace palpate
