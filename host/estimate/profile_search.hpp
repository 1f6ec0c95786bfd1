// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <vector>

#include "host/estimate/fit.hpp"
#include "solver/base/log.hpp"
#include "solver/base/tasks.hpp"

namespace palpate {

/// A 95 % interval on the transformed scale.
struct TransformedInterval {
    std::array<double, 2> ends{0, 0};
    bool is_profiled = false;  ///< else so many sd to either side
    /// Whether an end is where the model has no prediction any more, the end of what is allowed, or
    /// as far as was looked.
    std::array<bool, 2> is_cut{false, false};
    std::array<double, 2> rise{0, 0};  ///< of F at the ends, as found; 0: not looked at
};

/// A parameter whose interval is wanted, so many sd to either side (1.96 for 95 %).
struct WantedInterval {
    Index parameter;
    double reach;
};

/// Makes a model of the same data that costs less than the one of a fit and says there what that
/// one says (`CorrectedProblem`), or null.
using ProfileGuide = std::function<std::unique_ptr<const DataProblem>()>;

/// Minus the log posterior around a fit, its discrepancies held.
class ProfileSearch {
public:
    ///   make_guide   searches begin where its model leads; it is called when there is one to make.
    ///                May be empty
    ProfileSearch(const DataProblem& problem, const Fit& fit, const Eigen::MatrixXd& covariance,
                  const GaussNewtonOptions& options, ProfileGuide make_guide,
                  const ProgressSink& progress);

    /// The intervals: quadratic if at both ends, the others searched anew, F has risen by
    /// reach^2 / 2 up to the share `tolerance`; else where it has risen by that. Ends are looked
    /// for by `jobs` at a time, and are the same for any number of them.
    std::vector<TransformedInterval> intervals(const std::vector<WantedInterval>& wanted,
                                               double tolerance, int jobs);

    /// Whether the data without the prior of k exclude its lowest and its highest value: their
    /// ends, or 4 sd of the prior; as `excluded_ends` of posterior.hpp. True where there is no end
    /// at all.
    /// `interval` is that of k from `intervals`: what it excludes by the data alone is not
    /// predicted again, as if F did not fall farther out.
    std::array<bool, 2> excluded_ends(Index k, const TransformedInterval& interval);

    int num_prediction() const { return num_prediction_; }

private:
    struct Point {
        double z = 0;  ///< sqrt(2 rise); infinite without a prediction
        Eigen::VectorXd transformed;
        std::shared_ptr<const Prediction> prediction;
        std::shared_ptr<const Prediction> guided = nullptr;  ///< of the guide, near there; or null
    };
    Eigen::VectorXd on_ridge(Index k, double t) const;
    Eigen::VectorXd within(Eigen::VectorXd transformed) const;
    double rise_at(const Eigen::VectorXd& transformed);
    std::shared_ptr<const Prediction> guided(Index k, const Eigen::VectorXd& start,
                                             const Point& nearest);
    bool minimise(Index k, const Eigen::VectorXd& values, const Point& nearest, Point& point);
    Point profile_at(Index k, double t, const Point& nearest);
    Point quadratic_end(const WantedInterval& wanted, int side);
    double profile_end(Index k, double reach, double direction, Point first, bool& is_cut);
    double farthest(Index k, double direction) const;
    bool is_excluded_within(Index k, const TransformedInterval& interval, int side) const;
    double prior_rise(Index k, double t) const;
    double data_rise(Index k, const Eigen::VectorXd& transformed);

    const DataProblem& problem_;
    const std::vector<Parameter>& parameters_;
    const Fit& fit_;
    const Eigen::MatrixXd& covariance_;
    GaussNewtonOptions options_;
    ProfileGuide make_guide_;
    std::unique_ptr<const DataProblem> guide_;
    SharedProgress shared_;
    ProgressSink progress_;  ///< of `shared_`
    TransformedRange range_;
    TransformedPriors priors_;
    double lowest_ = 0;
    std::atomic<int> num_prediction_ = 0;
};

}  // namespace palpate
