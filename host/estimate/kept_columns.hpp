// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/estimate/data_problem.hpp"

namespace palpate {

/// `made`, which has no columns, with those of `near`: d predicted / d transformed is the same.
std::shared_ptr<const Prediction> with_columns_of(const std::shared_ptr<const Prediction>& near,
                                                  const std::shared_ptr<const Prediction>& made,
                                                  const std::vector<Parameter>& parameters);

/// Where the columns of a prediction were made, [num_parameter] on the parameters' own scales.
inline const Eigen::VectorXd& place_of_columns(const Prediction& prediction) {
    return prediction.columns_of ? prediction.columns_of->values : prediction.values;
}

}  // namespace palpate
