// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/quasi_newton.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

const Eigen::Vector2d truth(1.5, 3.0);
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A bowl around `truth` whose `bad_call`-th evaluation, and with `for_ever` each later one, is not
/// finite.
class FaultyBowl : public Objective {
public:
    FaultyBowl(int bad_call, double bad, bool for_ever = false)
        : bad_call_(bad_call), bad_(bad), for_ever_(for_ever) {}

    Evaluation evaluate(const Eigen::VectorXd& theta, bool) const override {
        Evaluation found{value(theta), 0, 2 * (theta - truth)};
        if (is_bad()) {
            found.objective = bad_;
            found.gradient[1] = bad_;
        }
        return found;
    }
    std::vector<double> objectives(const std::vector<Eigen::VectorXd>& thetas) const override {
        std::vector<double> values;
        for (const auto& theta : thetas) values.push_back(is_bad() ? bad_ : value(theta));
        return values;
    }
    Eigen::MatrixXd hessian(const Eigen::VectorXd&) const override {
        Eigen::MatrixXd exact = 2 * Eigen::Matrix2d::Identity();
        if (is_bad()) exact(0, 1) = bad_;
        return exact;
    }
    Eigen::MatrixXd seen_information(const Eigen::VectorXd& theta) const override {
        return hessian(theta);
    }
    const std::vector<Unknown>& unknowns() const override { return unknowns_; }

private:
    static double value(const Eigen::VectorXd& theta) { return (theta - truth).squaredNorm(); }
    bool is_bad() const {
        ++calls_;
        return calls_ == bad_call_ || (for_ever_ && calls_ > bad_call_);
    }

    int bad_call_;
    double bad_;
    bool for_ever_;
    mutable int calls_ = 0;
    std::vector<Unknown> unknowns_{{2, 2.0, 1.0}, {3, 2.0, 1.0}};
};

const Bounds wide = same_bounds(2, std::log(0.1), std::log(1e5));

TEST(QuasiNewton, ScanOverlooksWhatIsNotFinite) {
    for (const double bad : {std::nan(""), infinity})
        for (int call = 1; call <= 20; ++call)
            EXPECT_LT((scan_grid(FaultyBowl(call, bad), wide) - truth).norm(), 1.2) << call;
    EXPECT_TRUE(scan_grid(FaultyBowl(1, std::nan(""), true), wide) == Eigen::Vector2d(2, 2));
}

TEST(QuasiNewton, EndsInAFinitePointWhateverCallIsNotFinite) {
    const Eigen::Vector2d start(-1, 8);
    for (const double bad : {std::nan(""), infinity, -infinity})
        for (int call = 1; call <= 20; ++call)
            for (const bool for_ever : {false, true}) {
                SCOPED_TRACE(fmt::format("{} at call {}, for ever {}", bad, call, for_ever));
                const FaultyBowl bowl(call, bad, for_ever);
                if (call == 1) {
                    EXPECT_THROW(minimise_bfgs(bowl, start, wide), Error);
                    continue;
                }

                const Minimum found = minimise_bfgs(bowl, start, wide);

                EXPECT_TRUE(found.theta.allFinite());
                EXPECT_TRUE(std::isfinite(found.gradient_norm));
                EXPECT_LE((found.theta - truth).norm(), (start - truth).norm() + 1e-12);
                if (!for_ever) {
                    EXPECT_LT((found.theta - truth).norm(), 0.05);
                }
            }
}

TEST(QuasiNewton, StaysAtTheBoundsBeyondWhichTheMinimumLies) {
    const Bounds narrow = same_bounds(2, 2.0, 2.5);
    for (const double start : {2.0, 2.25, 2.5}) {
        const Minimum found =
            minimise_bfgs(FaultyBowl(0, 0), Eigen::Vector2d::Constant(start), narrow);
        EXPECT_LT((found.theta - Eigen::Vector2d(2.0, 2.5)).norm(), 1e-6) << start;
    }
}

}  // namespace
}  // namespace palpate
