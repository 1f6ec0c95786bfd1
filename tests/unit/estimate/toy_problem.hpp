// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <complex>
#include <functional>
#include <utility>
#include <vector>

#include "host/estimate/data_problem.hpp"

namespace palpate {

/// A parameter v = start on a scale of its own without a prior.
inline Parameter flat_parameter(std::string name, double start) {
    Parameter parameter;
    parameter.name = std::move(name);
    parameter.start = parameter.median = start;
    return parameter;
}

/// A positive parameter with a prior of ln.
inline Parameter log_parameter(std::string name, double start, double median, double sd_ln) {
    Parameter parameter = flat_parameter(std::move(name), start);
    parameter.transform = Transform::log;
    parameter.median = median;
    parameter.sd = sd_ln;
    return parameter;
}

/// Data given by a formula: `model(values, row)` is written for complex numbers, so that columns
/// are exact: d f / d v = Im f(v + i h) / h.
class ToyProblem : public DataProblem {
public:
    using Number = std::complex<double>;
    using Model = std::function<Number(const std::vector<Number>& values, Index row)>;

    ToyProblem(std::vector<Parameter> parameters, DataBlock data, Model model)
        : parameters_(std::move(parameters)), data_(std::move(data)), model_(std::move(model)) {}

    const std::vector<Parameter>& parameters() const override { return parameters_; }
    PredictionAttempt predict(const Eigen::VectorXd& values, PredictedColumns columns,
                              const Prediction* warm) const override {
        ++std::atomic_ref(num_prediction);
        std::atomic_ref(num_warm) += warm ? 1 : 0;
        if ((fails && fails(values)) || (warm && fails_warm && fails_warm(values)))
            return {nullptr, "no equilibrium"};
        auto made = std::make_shared<Prediction>();
        made->values = values;
        made->blocks = {data_};
        DataBlock& block = made->blocks[0];
        std::vector<Number> at(values.begin(), values.end());
        block.predicted.resize(block.num_row());
        for (Index i = 0; i < block.num_row(); ++i) block.predicted[i] = model_(at, i).real();
        if (columns == PredictedColumns::wanted) block.columns = exact_columns(at);
        return {made, ""};
    }

    std::vector<Parameter>& mutable_parameters() { return parameters_; }
    DataBlock& data() { return data_; }

    std::function<bool(const Eigen::VectorXd&)> fails;
    std::function<bool(const Eigen::VectorXd&)> fails_warm;  ///< only from an earlier prediction
    mutable int num_prediction = 0, num_warm = 0;

private:
    Eigen::MatrixXd exact_columns(std::vector<Number> at) const {
        constexpr double h = 1e-40;
        Eigen::MatrixXd columns(data_.num_row(), at.size());
        for (std::size_t k = 0; k < at.size(); ++k) {
            at[k] += Number(0, h);
            for (Index i = 0; i < data_.num_row(); ++i)
                columns(i, static_cast<Index>(k)) = model_(at, i).imag() / h;
            at[k] = at[k].real();
        }
        return columns;
    }

    std::vector<Parameter> parameters_;
    DataBlock data_;
    Model model_;
};

/// A block with these measurements and the same sd in all rows.
inline DataBlock toy_block(const Eigen::VectorXd& measured, double sd) {
    DataBlock block;
    block.name = "toy";
    block.kind = "force";
    block.unit = "mN";
    block.measured = measured;
    block.sd = Eigen::VectorXd::Constant(measured.size(), sd);
    return block;
}

}  // namespace palpate
