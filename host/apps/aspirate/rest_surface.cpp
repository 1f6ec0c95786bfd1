// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/rest_surface.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "host/apps/aspirate/median.hpp"

namespace palpate {
namespace {

constexpr int even_terms = 5, rounds = 12;
constexpr double least_seen_part = 0.3;  // of the hole's radius
constexpr double anchor_share = 0.2;     // of the points' weight holds the end at the rim
constexpr double least_spread_mm = 0.004, sample_mm = 0.2, cell_mm = 0.1;

using Terms = Eigen::Matrix<double, even_terms, 1>;

// 1, s, s^2, ... with s = (r / end)^2
Terms terms_at(double r_mm, double end_mm) {
    Terms terms;
    double power = 1;
    for (int k = 0; k < even_terms; ++k, power *= r_mm * r_mm / (end_mm * end_mm)) terms[k] = power;
    return terms;
}

double asymmetry_of(const std::vector<ProfilePoint>& points) {
    std::map<int, std::array<double, 4>> cells;  // sums and counts left and right
    for (const ProfilePoint& point : points) {
        auto& cell = cells[int(std::abs(point.r_mm) / cell_mm)];
        const int side = point.r_mm < 0 ? 0 : 2;
        cell[side] += point.z_mm;
        cell[side + 1] += 1;
    }
    double squares = 0, count = 0;
    for (const auto& [cell, sums] : cells)
        if (sums[1] > 0 && sums[3] > 0) {
            const double half = 0.5 * (sums[0] / sums[1] - sums[2] / sums[3]);
            squares += half * half;
            ++count;
        }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

double hidden_height(double r_mm, double z_mm, double end_mm) {
    return std::clamp(z_mm, 0.0, end_mm - r_mm);
}

FoundRest find_rest(const std::vector<FrameProfile>& frames, double lowest_mm,
                    double hole_radius_mm, double edge_radius_mm) {
    const double end_mm = hole_radius_mm + edge_radius_mm;
    std::vector<ProfilePoint> points;
    double farthest_mm = 0;
    for (const FrameProfile& frame : frames)
        for (const ProfilePoint& point : frame.points)
            if (point.flag == PointFlag::ok && point.z_mm > lowest_mm) {
                points.push_back(point);
                farthest_mm = std::max(farthest_mm, std::abs(point.r_mm));
            }
    FoundRest found;
    found.asymmetry_mm = asymmetry_of(points);
    found.is_seen =
        farthest_mm > least_seen_part * hole_radius_mm && Index(points.size()) > 10 * even_terms;
    Terms shape = Terms::Zero();
    double scale = 1e3;
    for (int round = 0; found.is_seen && round < rounds; ++round) {
        Eigen::Matrix<double, even_terms, even_terms> normal =
            Eigen::Matrix<double, even_terms, even_terms>::Zero();
        Terms right = Terms::Zero();
        double total = 0;
        std::vector<double> away;
        for (const ProfilePoint& point : points) {
            const Terms terms = terms_at(point.r_mm, end_mm);
            const double residual = point.z_mm - shape.dot(terms), u = residual / (4.7 * scale);
            away.push_back(std::abs(residual));
            if (std::abs(u) >= 1) continue;
            const double w = std::pow(1 - u * u, 2) / (point.sd_mm * point.sd_mm + 1e-6);
            normal += w * terms * terms.transpose();
            right += w * point.z_mm * terms;
            total += w;
        }
        const Terms at_end = terms_at(end_mm, end_mm);
        normal += anchor_share * total * at_end * at_end.transpose();
        normal.diagonal().array() += 1e-9 * total;
        shape = normal.ldlt().solve(right);
        scale = round == 0 ? 1e3 : std::max(least_spread_mm, 1.4826 * median(away));
        found.left_rms_mm = 1.4826 * median(away);
    }
    // Where the curve goes below the line: single points beyond it may be bubbles.
    constexpr double step_mm = 0.02;
    while (found.is_seen && found.seen_to_mm + step_mm <= farthest_mm &&
           shape.dot(terms_at(found.seen_to_mm + step_mm, end_mm)) > lowest_mm)
        found.seen_to_mm += step_mm;
    const int count = std::max(3, int(std::ceil(end_mm / sample_mm)));
    for (int k = 0; k <= count; ++k) {
        const double r = end_mm * k / count;
        const double height_mm = shape.dot(terms_at(r, end_mm));
        const double z =
            r > found.seen_to_mm ? hidden_height(r, height_mm, end_mm) : std::max(0.0, height_mm);
        found.surface.r_mm.push_back(r);
        found.surface.z_mm.push_back(k == count ? 0 : z);
    }
    return found;
}

}  // namespace palpate
