// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/kept_columns.hpp"

namespace palpate {

std::shared_ptr<const Prediction> with_columns_of(const std::shared_ptr<const Prediction>& near,
                                                  const std::shared_ptr<const Prediction>& made,
                                                  const std::vector<Parameter>& parameters) {
    const auto slopes_at = [&](const Eigen::VectorXd& values) {
        return slopes_of(parameters, to_transformed(parameters, values));
    };
    // dy/dv = dy/dt dt/dv, with dy/dt of the other place
    const Eigen::VectorXd factors = slopes_at(near->values).cwiseQuotient(slopes_at(made->values));
    auto both = std::make_shared<Prediction>();
    both->values = made->values;
    both->blocks = made->blocks;
    for (std::size_t b = 0; b < both->blocks.size(); ++b)
        both->blocks[b].columns = near->blocks[b].columns * factors.asDiagonal();
    both->columns_of = near->columns_of ? near->columns_of : near;
    both->solved = made;
    return both;
}

}  // namespace palpate
