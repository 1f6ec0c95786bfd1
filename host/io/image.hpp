// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Where the voxels of a volume lie in LPS patient space (mm). Voxel (i, j, k) has its centre at
/// origin + direction * (i sx, j sy, k sz); index i runs fastest in memory.
struct ImageGrid {
    std::array<Index, 3> size{0, 0, 0};
    Vec3 origin = Vec3::Zero();         ///< centre of voxel (0, 0, 0), mm
    Vec3 spacing = Vec3::Ones();        ///< mm
    Mat3 direction = Mat3::Identity();  ///< columns: unit vectors of the i, j, k axes; det = +-1

    std::size_t num_voxels() const {
        return std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
    }
    std::size_t offset(Index i, Index j, Index k) const {
        return std::size_t(i) + std::size_t(size[0]) * (std::size_t(j) + std::size_t(size[1]) * k);
    }
    Vec3 to_point(const Vec3& index) const {
        return origin + direction * index.cwiseProduct(spacing);
    }
    /// Continuous voxel index of a point; voxel centres are whole numbers.
    Vec3 to_index(const Vec3& point) const {
        return (direction.transpose() * (point - origin)).cwiseQuotient(spacing);
    }
    double voxel_volume() const { return spacing.prod(); }
    /// Whether the voxels of both lie at the same places, to a thousandth of a mm.
    bool is_like(const ImageGrid& other) const {
        const auto near = [&](const Vec3& index) {
            return (to_point(index) - other.to_point(index)).norm() < 1e-3;
        };
        return size == other.size && near(Vec3::Zero()) && near(Vec3::Ones());
    }
};

template <typename T>
struct Image {
    ImageGrid grid;
    std::vector<T> voxels;  ///< [num_voxels], i fastest

    const T& at(Index i, Index j, Index k) const { return voxels[grid.offset(i, j, k)]; }
    T& at(Index i, Index j, Index k) { return voxels[grid.offset(i, j, k)]; }
};

/// A rigid motion y = rotation x + translation, LPS mm.
struct RigidTransform {
    Mat3 rotation = Mat3::Identity();
    Vec3 translation = Vec3::Zero();

    Vec3 apply(const Vec3& x) const { return rotation * x + translation; }
    RigidTransform inverse() const {
        return {rotation.transpose(), -(rotation.transpose() * translation)};
    }
};

}  // namespace palpate
