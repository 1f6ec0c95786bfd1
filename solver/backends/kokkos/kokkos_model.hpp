// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "solver/backends/kokkos/model_kernels.hpp"
#include "solver/mesh/node_elements.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// A model on the device. Blocks of the assembled stiffness and stored gradients come into being
/// when they are first asked for, and follow `set_stiffness`.
template <typename Real>
class KokkosModel {
public:
    explicit KokkosModel(const Model& model);

    /// New Young's moduli, kPa, one per region.
    void set_stiffness(std::span<const double> stiffness_kpa);

    Index num_nodes() const { return num_nodes_; }
    Index num_dofs() const { return 3 * num_nodes_; }
    Index num_regions() const { return static_cast<Index>(materials_.size()); }
    const LinearElastic& material(Index region) const { return materials_[region]; }

    /// K as an operator, with its inverted diagonal; its blocks only after `assemble`.
    KokkosOperator<Real>& stiffness() { return stiffness_; }
    void assemble();
    void drop_blocks() { stiffness_.blocks = {}; }
    void drop_gradients() { gradients_ = {}; }

    /// With prescribed dofs as identity, or without regard to them.
    DeviceMesh constrained_mesh() const;
    DeviceMesh free_mesh() const;

    template <typename Number>
    RecomputedGeometry<Number> recomputed() const {
        return {nodes_.data(), tets_.data()};
    }
    StoredGeometry<Real> stored();

    /// Numbers of the tetrahedra of one region, on the device.
    const Index* tets_of(Index region) const { return tets_by_region_.data() + starts_[region]; }
    Index num_tets_of(Index region) const { return starts_[region + 1] - starts_[region]; }

private:
    void copy_mesh(const Mesh& mesh);
    void sort_tets_by_region(const Mesh& mesh);
    void update_values();

    Index num_nodes_ = 0;
    Index num_tets_ = 0;
    std::vector<LinearElastic> materials_;
    std::vector<Index> starts_;  ///< [num_regions + 1], into `tets_by_region_`
    Array<double> nodes_;
    Array<Index> tets_;
    Array<Index> region_;
    Array<Index> tets_by_region_;
    Array<Index> corner_offsets_;
    Array<Index> corners_;
    Array<std::uint8_t> prescribed_;
    Array<double> lame_;     ///< [num_regions, 2], kPa
    Array<Real> gradients_;  ///< of `StoredGeometry`, or empty
    KokkosOperator<Real> stiffness_;
};

template <typename Real>
KokkosModel<Real>::KokkosModel(const Model& model)
    : num_nodes_(model.mesh.num_nodes()),
      num_tets_(model.mesh.num_tets()),
      materials_(model.materials),
      prescribed_(array_of(model.prescribed)),
      lame_(make_array<double>(2 * model.materials.size())),
      stiffness_(model.num_dofs()) {
    copy_mesh(model.mesh);
    sort_tets_by_region(model.mesh);
    const Adjacency graph = node_graph(model.mesh);
    stiffness_.offsets = array_of(graph.offsets);
    stiffness_.items = array_of(graph.items);
    stiffness_.inverse_diagonal = make_array<Real>(9 * static_cast<std::size_t>(num_nodes_));
    update_values();
}

template <typename Real>
void KokkosModel<Real>::copy_mesh(const Mesh& mesh) {
    std::vector<double> nodes;
    for (const Vec3& node : mesh.nodes) nodes.insert(nodes.end(), node.data(), node.data() + 3);
    std::vector<Index> tets;
    for (const Tet& tet : mesh.tets) tets.insert(tets.end(), tet.begin(), tet.end());
    const Adjacency corners = corners_of_nodes(mesh);
    nodes_ = array_of(nodes);
    tets_ = array_of(tets);
    region_ = array_of(mesh.region);
    corner_offsets_ = array_of(corners.offsets);
    corners_ = array_of(corners.items);
}

template <typename Real>
void KokkosModel<Real>::sort_tets_by_region(const Mesh& mesh) {
    std::vector<Index> tets(mesh.tets.size());
    std::iota(tets.begin(), tets.end(), 0);
    std::stable_sort(tets.begin(), tets.end(),
                     [&](Index a, Index b) { return mesh.region[a] < mesh.region[b]; });
    starts_.assign(materials_.size() + 1, 0);
    for (Index region : mesh.region) ++starts_[region + 1];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    tets_by_region_ = array_of(tets);
}

template <typename Real>
void KokkosModel<Real>::set_stiffness(std::span<const double> stiffness_kpa) {
    for (std::size_t r = 0; r < materials_.size(); ++r)
        materials_[r].stiffness_kpa = stiffness_kpa[r];
    update_values();
}

template <typename Real>
void KokkosModel<Real>::update_values() {
    std::vector<double> lame;
    for (const LinearElastic& material : materials_) {
        lame.push_back(material.stiffness_kpa * material.unit_lambda());
        lame.push_back(material.stiffness_kpa * material.unit_mu());
    }
    write_array(std::span<const double>(lame), lame_);
    for_each_work(num_nodes_, InvertDiagonal<Real>{constrained_mesh(), recomputed<double>(),
                                                   stiffness_.inverse_diagonal.data()});
    if (stiffness_.blocks.size() > 0) {
        drop_blocks();
        assemble();
    }
}

template <typename Real>
void KokkosModel<Real>::assemble() {
    if (stiffness_.blocks.size() > 0) return;
    stiffness_.blocks = make_array<Real>(9 * stiffness_.items.size());
    for_each_work(num_nodes_, AssembleRows<Real>{constrained_mesh(), recomputed<double>(),
                                                 stiffness_.offsets.data(), stiffness_.items.data(),
                                                 stiffness_.blocks.data()});
}

template <typename Real>
StoredGeometry<Real> KokkosModel<Real>::stored() {
    if (gradients_.size() == 0) {
        gradients_ = make_array<Real>(StoredGeometry<Real>::numbers_per_tet *
                                      static_cast<std::size_t>(num_tets_));
        for_each_work(num_tets_, StoreGeometry<Real>{recomputed<double>(), gradients_.data()});
    }
    return {gradients_.data()};
}

template <typename Real>
DeviceMesh KokkosModel<Real>::free_mesh() const {
    return {tets_.data(),    region_.data(), corner_offsets_.data(),
            corners_.data(), lame_.data(),   nullptr};
}

template <typename Real>
DeviceMesh KokkosModel<Real>::constrained_mesh() const {
    DeviceMesh mesh = free_mesh();
    mesh.prescribed = prescribed_.data();
    return mesh;
}

}  // namespace palpate
