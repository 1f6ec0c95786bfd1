// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/geometry/fields/label_field.hpp"

namespace palpate {

/// Label of everything beyond the image box. Region 0 inside the box is another label than this.
constexpr std::uint8_t beyond_box = 255;

/// Region numbers on a regular lattice of cells that covers the image box exactly. Its frame is the
/// image's: axes along i, j, k, mm, origin at the corner of the first voxel.
struct LabelLattice {
    std::array<Index, 3> size{0, 0, 0};  ///< cells
    Vec3 spacing = Vec3::Ones();         ///< mm, about equal
    std::vector<std::uint8_t> labels;    ///< one per cell, i fastest

    std::size_t offset(Index i, Index j, Index k) const {
        return std::size_t(i) + std::size_t(size[0]) * (std::size_t(j) + std::size_t(size[1]) * k);
    }
    bool is_inside(Index i, Index j, Index k) const {
        return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
    }
    std::uint8_t at(Index i, Index j, Index k) const {
        return is_inside(i, j, k) ? labels[offset(i, j, k)] : beyond_box;
    }
    Vec3 centre(Index i, Index j, Index k) const {
        return Vec3(i + 0.5, j + 0.5, k + 0.5).cwiseProduct(spacing);
    }
};

/// The region of the smooth field at the centre of each cell of about `spacing_mm`.
LabelLattice sample_labels(const RegionImage& image, const LabelField& field, double spacing_mm);

/// Gives cells that lie in no 2 x 2 x 2 block of their own label (sheets and strands one cell thin,
/// which a surface of the wanted edge length cannot carry) to the label around them that the field
/// prefers. Beyond the box any label continues.
void remove_thin_parts(LabelLattice& lattice, const ImageGrid& grid, const LabelField& field);

/// Evens out the curves where three labels meet: near them each cell takes the label that most of
/// the 27 cells around it have. Where organs barely touch, sampling leaves a ragged contact.
void even_out_contacts(LabelLattice& lattice, int rounds);

/// Gives connected pieces smaller than `min_volume_mm3` to the label around them. The largest piece
/// of each organ stays.
void remove_specks(LabelLattice& lattice, double min_volume_mm3);

/// Switches cells until each label's boundary is a 2-manifold: in every 2 x 2 x 2 block both the
/// label and its complement are connected through faces (Latecki's well-composed sets, for every
/// label). The cells that switch are those where the field objects least.
/// Throws Error(mesh_failed) if that does not end.
void make_well_composed(LabelLattice& lattice, const ImageGrid& grid, const LabelField& field);

}  // namespace palpate
