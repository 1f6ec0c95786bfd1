// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/row_correlations.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

RowCorrelations::RowCorrelations(const std::vector<Vec3>& places,
                                 const std::vector<SlicePlaces>& slices,
                                 const std::array<double, max_terraces>& range_mm) {
    std::vector<double> ranges;
    for (int k = 0; k < max_terraces; ++k) {
        const auto place = std::find(ranges.begin(), ranges.end(), range_mm[k]);
        decay_of_wave_[k] = static_cast<int>(place - ranges.begin());
        if (place == ranges.end()) ranges.push_back(range_mm[k]);
    }
    const Index n = static_cast<Index>(places.size());
    smooth_.resize(n, n);
    by_slice_.resize(n, n);
    decay_.assign(ranges.size(), Eigen::MatrixXd::Zero(n, n));
    for (Index j = 0; j < n; ++j) {
        for (Index i = j; i < n; ++i) {
            const double distance = (places[i] - places[j]).norm();
            smooth_(i, j) = smooth_(j, i) = contour_correlation(distance);
            by_slice_(i, j) = by_slice_(j, i) = slice_correlation(slices[i], slices[j], distance);
            for (std::size_t r = 0; r < ranges.size(); ++r)
                if (ranges[r] > 0)
                    decay_[r](i, j) = decay_[r](j, i) = std::exp(-distance / ranges[r]);
        }
    }
}

}  // namespace palpate
