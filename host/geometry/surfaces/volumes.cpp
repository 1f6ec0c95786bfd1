// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/volumes.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>

#include "host/geometry/surfaces/remesh.hpp"

namespace palpate {
namespace {

// Offsets (mm) that the balance of volumes asks for; regions that touch nothing get none.
Eigen::VectorXd offsets_for(const SurfaceComplex& complex, const Eigen::VectorXd& missing) {
    Eigen::MatrixXd areas = Eigen::MatrixXd::Zero(missing.size(), missing.size());
    for (const auto& face : complex.faces) {
        if (face.plane >= 0) continue;
        const Index a = face.regions[0], b = face.regions[1];
        const double area = complex.area_vector(face).norm() / 2;
        areas(a, a) += area;
        areas(b, b) += area;
        areas(a, b) -= area;
        areas(b, a) -= area;
    }
    // least-squares solution of least norm: a common offset of all regions moves nothing
    return areas.completeOrthogonalDecomposition().solve(missing);
}

}  // namespace

std::vector<double> enclosed_volumes(const SurfaceComplex& complex, Index num_regions) {
    std::vector<double> volumes(std::size_t(num_regions), 0.0);
    for (const auto& face : complex.faces) {
        const double volume = complex.points[face.v[0]].dot(
                                  complex.points[face.v[1]].cross(complex.points[face.v[2]])) /
                              6;
        volumes[face.regions[0]] += volume;
        if (face.regions[1] != beyond_box) volumes[face.regions[1]] -= volume;
    }
    return volumes;
}

void match_volumes(SurfaceComplex& complex, Interfaces& interfaces,
                   const std::vector<double>& wanted, int rounds) {
    constexpr double max_offset_mm = 1.0;
    const Index num_regions = Index(wanted.size());
    for (int round = 0; round < rounds; ++round) {
        const auto enclosed = enclosed_volumes(complex, num_regions);
        Eigen::VectorXd missing(num_regions);
        for (Index r = 0; r < num_regions; ++r) missing[r] = wanted[r] - enclosed[r];
        const Eigen::VectorXd offset = offsets_for(complex, missing);
        for (Index r = 0; r < num_regions; ++r)  // the interface moves by half the difference
            interfaces.offsets()[r] += std::clamp(2 * offset[r], -max_offset_mm, max_offset_mm);
        settle(complex, interfaces, 0);
        settle(complex, interfaces, 0);
    }
}

}  // namespace palpate
