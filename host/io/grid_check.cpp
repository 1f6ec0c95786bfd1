// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/grid_check.hpp"

#include <Eigen/SVD>
#include <sstream>

#include "solver/base/error.hpp"

namespace palpate {

ImageGrid checked_grid(ImageGrid grid) {
    constexpr double largest_mm = 1e6;
    const bool is_finite = grid.origin.allFinite() && grid.spacing.allFinite() &&
                           grid.direction.allFinite() &&
                           grid.origin.cwiseAbs().maxCoeff() <= largest_mm;
    if (!is_finite || grid.spacing.minCoeff() <= 1e-6 || grid.spacing.maxCoeff() > largest_mm) {
        std::ostringstream text;
        text << "its grid makes no sense: spacing " << grid.spacing.transpose() << " mm, origin "
             << grid.origin.transpose() << " mm";
        throw Error(ErrorCode::input_unusable, text.str());
    }
    const Mat3 gram = grid.direction.transpose() * grid.direction;
    if ((gram - Mat3::Identity()).cwiseAbs().maxCoeff() > 1e-3) {
        throw Error(ErrorCode::input_unusable,
                    "its axes are not at right angles (sheared); resample it to a plain grid");
    }
    const Eigen::JacobiSVD<Mat3> svd(grid.direction, Eigen::ComputeFullU | Eigen::ComputeFullV);
    grid.direction = svd.matrixU() * svd.matrixV().transpose();
    return grid;
}

}  // namespace palpate
