// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/row_correlations.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace palpate {

RowCorrelations::RowCorrelations(const std::vector<LinearRow>& rows) {
    std::vector<double> ranges;
    for (int k = 0; k < max_terraces && !rows.empty(); ++k) {
        const double range = rows.front().range_mm[k];
        const auto place = std::find(ranges.begin(), ranges.end(), range);
        decay_of_wave_[k] = static_cast<int>(place - ranges.begin());
        if (place == ranges.end()) ranges.push_back(range);
    }
    const Index n = static_cast<Index>(rows.size());
    smooth_.resize(n, n);
    by_slice_.resize(n, n);
    decay_.assign(ranges.size(), Eigen::MatrixXd::Zero(n, n));
    for (Index j = 0; j < n; ++j) {
        for (Index i = j; i < n; ++i) {
            const double distance = (rows[i].place - rows[j].place).norm();
            smooth_(i, j) = smooth_(j, i) = contour_correlation(distance);
            by_slice_(i, j) = by_slice_(j, i) =
                slice_correlation(rows[i].slices, rows[j].slices, distance);
            for (std::size_t r = 0; r < ranges.size(); ++r)
                if (ranges[r] > 0)
                    decay_[r](i, j) = decay_[r](j, i) = std::exp(-distance / ranges[r]);
        }
    }
}

double RowCorrelations::noise_covariance(const LinearRow& a, const LinearRow& b) const {
    const Index i = a.place_in_known, j = b.place_in_known;
    double contours = smooth_(i, j);
    if (a.slice_share != 0)
        contours = (1.0 - a.slice_share) * contours + a.slice_share * by_slice_(i, j);
    double sum = a.contour_mm * b.contour_mm * contours;
    for (int k = 0; k < max_terraces; ++k) {
        const double wave = a.terraces.waves.col(k).dot(b.terraces.waves.col(k));
        if (wave != 0) sum += wave * decay_[decay_of_wave_[k]](i, j);
    }
    return sum;
}

void remember_correlations(std::vector<LinearRow>& rows) {
    std::map<std::pair<Index, bool>, std::vector<Index>> groups;
    for (std::size_t k = 0; k < rows.size(); ++k)
        groups[{rows[k].surface, rows[k].on_driven}].push_back(static_cast<Index>(k));
    for (const auto& [surface, members] : groups) {
        std::vector<LinearRow> group;
        for (const Index k : members) group.push_back(rows[k]);
        const auto known = std::make_shared<const RowCorrelations>(group);
        for (std::size_t m = 0; m < members.size(); ++m) {
            rows[members[m]].known = known;
            rows[members[m]].place_in_known = static_cast<Index>(m);
        }
    }
}

}  // namespace palpate
