// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "host/estimate/corrected_problem.hpp"
#include "host/estimate/identified.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

/// a_1 exp(-t / tau_1) + a_2 exp(-t / tau_2) of times that lie near each other: their posterior is
/// bent, and a straight line leads far off it. `off` is what a cheap model has wrong.
ToyProblem two_decays(double off) {
    constexpr Index count = 40;
    constexpr double apart_s = 0.25;
    Eigen::VectorXd measured(count);
    for (Index i = 0; i < count; ++i)
        measured[i] = 0.6 * std::exp(-apart_s * i / 0.7) + 0.4 * std::exp(-apart_s * i / 2.5);
    return {{log_parameter("a1", 0.5, 0.5, 0.7), log_parameter("tau1", 0.5, 0.5, 0.7),
             log_parameter("a2", 0.5, 0.5, 0.7), log_parameter("tau2", 3, 3, 0.7)},
            toy_block(measured, 0.01),
            [off](const auto& v, Index i) {
                const double t = (1 + off) * apart_s * double(i);
                return (1 + off) * (v[0] * std::exp(-t / v[1]) + v[2] * std::exp(-t / v[3]));
            }};
}

/// An exact model at its optimum, and a cheap one.
class GuidedProfiles : public testing::Test {
protected:
    GuidedProfiles() {
        FitOptions options;
        options.discrepancy.is_learned = false;
        found_ = fit(exact_, options);
        cheap_at_ =
            checked_prediction(cheap_, found_.values, PredictedColumns::wanted, nullptr).prediction;
        alone_ = identify(exact_, found_, {});
    }
    Identified guided() {
        IdentifyOptions options;
        options.guide = [this] {
            ++num_guide_;
            return std::make_unique<CorrectedProblem>(cheap_, *found_.prediction, cheap_at_);
        };
        return identify(exact_, found_, options);
    }
    /// The ends are where they are without a guide, but for what a search along a profile may leave
    /// (3 % of the reach).
    void expect_same_ends(const Identified& guided) {
        int num_profiled = 0;
        for (std::size_t k = 0; k < guided.parameters.size(); ++k) {
            const IdentifiedParameter &own = guided.parameters[k], &other = alone_.parameters[k];
            EXPECT_EQ(own.is_profiled, other.is_profiled) << own.parameter.name;
            num_profiled += own.is_profiled;
            for (const int side : {0, 1})
                EXPECT_NEAR(std::log(own.interval[side] / own.value),
                            std::log(other.interval[side] / other.value),
                            0.05 * std::abs(std::log(other.interval[side] / other.value)))
                    << own.parameter.name << ", side " << side;
        }
        EXPECT_GE(num_profiled, 2);
    }

    ToyProblem exact_ = two_decays(0), cheap_ = two_decays(0.05);
    Fit found_;
    std::shared_ptr<const Prediction> cheap_at_;
    Identified alone_;
    int num_guide_ = 0;
};

TEST_F(GuidedProfiles, LeadsToTheSameEndsByFewerPredictions) {
    const Identified known = guided();

    expect_same_ends(known);
    EXPECT_LT(known.num_prediction, 0.75 * alone_.num_prediction);
    EXPECT_EQ(num_guide_, 1);
}

TEST_F(GuidedProfiles, IsNotMadeWhereThereAreNoProfiles) {
    for (Parameter& one : exact_.mutable_parameters()) one.is_nuisance = true;

    guided();

    EXPECT_EQ(num_guide_, 0);
}

TEST_F(GuidedProfiles, ThatLeadsToWhereTheModelFailsIsNotFollowed) {
    std::vector<Eigen::VectorXd> asked;  // of the guide, since the model was solved
    int num_failed = 0;
    cheap_.fails = [&](const Eigen::VectorXd& values) {
        asked.push_back(values);
        return false;
    };
    exact_.fails = [&](const Eigen::VectorXd& values) {
        if (asked.size() > 1 && values == asked.back()) {
            ++num_failed;
            return true;
        }
        asked.clear();
        return false;
    };

    expect_same_ends(guided());
    EXPECT_GT(num_failed, 4);
}

TEST_F(GuidedProfiles, ThatSaysNothingChangesNothing) {
    cheap_.fails = [](const auto&) { return true; };

    const Identified known = guided();

    expect_same_ends(known);
    EXPECT_EQ(known.num_prediction, alone_.num_prediction);
}

TEST_F(GuidedProfiles, ThatIsFarOffIsNotBelieved) {
    cheap_ = two_decays(0.5);

    expect_same_ends(guided());
}

}  // namespace
}  // namespace palpate
