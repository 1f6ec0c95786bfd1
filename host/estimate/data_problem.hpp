// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/estimate/parameter.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// Rows of data of one kind, and what the model says of them. All rows are in `unit`.
struct DataBlock {
    std::string name;  ///< which data: "film 1"; blocks of a problem have different names
    std::string kind;  ///< "force", "profile"; for reports
    std::string unit;
    Eigen::VectorXd predicted, measured;  ///< [num_row]
    Eigen::VectorXd sd;                   ///< [num_row] of the independent noise, above 0
    /// [num_row, num_parameter] d predicted / d parameter, on the parameters' own scales; empty if
    /// they were not asked for.
    Eigen::MatrixXd columns;

    /// Where and when each row was measured, for the kernel of the model discrepancy: [num_row, 1
    /// to 3] and [num_row]; empty where rows have no place or no time. Rows with neither have a
    /// discrepancy that is independent from row to row. They must not change with the parameters.
    Eigen::MatrixXd position_mm;
    Eigen::VectorXd time_s;
    double correlation_mm = 0, correlation_s = 0;  ///< lengths of that kernel; 0: to be learned
    bool has_discrepancy = true;  ///< false: what the model leaves in these rows is noise alone
    bool is_robust = true;        ///< whether rows far off count less (Huber)

    Index num_row() const { return static_cast<Index>(measured.size()); }
};

/// What a model says at one set of values. Problems derive from it to keep what makes a prediction
/// nearby cheap: states, factors, their derivatives.
struct Prediction {
    virtual ~Prediction() = default;
    Eigen::VectorXd values;  ///< [num_parameter] where it was made, on the parameters' own scales
    std::vector<DataBlock> blocks;
    /// Where its columns are those of one nearby (`with_columns_of`): that one, and this one as the
    /// model gave it. Null: they are its own.
    std::shared_ptr<const Prediction> columns_of = nullptr, solved = nullptr;
};

/// What the model gave: the prediction, or the one that it was made of; null of null.
const Prediction* solved_of(const Prediction* prediction);

/// A prediction, or why there is none.
struct PredictionAttempt {
    std::shared_ptr<const Prediction> prediction;  ///< null: it failed
    std::string failure;                           ///< then one clause: "no equilibrium at 3.2 s"
};

enum class PredictedColumns : std::uint8_t { none, wanted };

/// An inverse problem: parameters and a model that predicts data from them. Where `jobs` are asked
/// for, several threads call `predict` at the same time.
class DataProblem {
public:
    virtual ~DataProblem() = default;
    virtual const std::vector<Parameter>& parameters() const = 0;
    /// What the model says at `values`, [num_parameter] on the parameters' own scales, all within
    /// their ranges. `warm` is an earlier prediction of this problem, the nearest one that the
    /// engine has, or null. Blocks and their rows, measurements, noise and coordinates are the same
    /// at every call.
    ///
    /// No equilibrium is no error: give an attempt without a prediction, or throw
    /// Error(solve_failed), which is taken for one. Any other exception ends the estimate.
    virtual PredictionAttempt predict(const Eigen::VectorXd& values, PredictedColumns columns,
                                      const Prediction* warm) const = 0;
};

/// Calls `predict` and checks what comes: Error(solve_failed) and numbers that are not finite are a
/// failure. Throws Error(internal) where sizes do not fit or `values` is not what was asked for,
/// Error(input_unusable) where a measurement is not finite or an sd not above 0, with block and
/// row.
PredictionAttempt checked_prediction(const DataProblem& problem, const Eigen::VectorXd& values,
                                     PredictedColumns columns, const Prediction* warm);

/// d predicted / d transformed of a block that has columns: [num_row, num_parameter].
Eigen::MatrixXd transformed_columns(const DataBlock& block, const Eigen::VectorXd& slopes);

}  // namespace palpate
