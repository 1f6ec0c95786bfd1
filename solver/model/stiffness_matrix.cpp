// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/stiffness_matrix.hpp"

#include <algorithm>

#include "solver/base/parallel.hpp"
#include "solver/elements/tet4.hpp"

namespace palpate {
namespace {

constexpr Index nodes_per_thread = 500;

std::vector<Tet4> all_geometry(const Mesh& mesh) {
    std::vector<Tet4> geometry(mesh.tets.size());
    parallel_ranges(mesh.num_tets(), nodes_per_thread, [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) {
            const Tet& tet = mesh.tets[t];
            geometry[t] = tet4_geometry(mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]],
                                        mesh.nodes[tet[3]]);
        }
    });
    return geometry;
}

/// Adds the blocks that the corner `a` of tet `t` gives to the block row of its node.
void add_corner(const Model& model, const Tet4& geometry, Index t, int a, StiffnessMatrix& matrix) {
    const Tet& tet = model.mesh.tets[t];
    const LinearElastic& material = model.materials[model.mesh.region[t]];
    const double lambda = material.stiffness_kpa * material.unit_lambda();
    const double mu = material.stiffness_kpa * material.unit_mu();
    const auto row = matrix.graph.items.begin() + matrix.graph.offsets[tet[a]];
    const auto row_end = matrix.graph.items.begin() + matrix.graph.offsets[tet[a] + 1];
    for (int b = 0; b < 4; ++b) {
        const auto entry = std::lower_bound(row, row_end, tet[b]) - matrix.graph.items.begin();
        Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&matrix.blocks[9 * entry]) +=
            tet4_stiffness_block(geometry, a, b, lambda, mu);
    }
}

}  // namespace

StiffnessMatrix assemble_stiffness(const Model& model) {
    StiffnessMatrix matrix{node_graph(model.mesh), {}};
    matrix.blocks.assign(9 * matrix.graph.items.size(), 0.0);
    const Adjacency corners = corners_of_nodes(model.mesh);
    const std::vector<Tet4> geometry = all_geometry(model.mesh);
    parallel_ranges(matrix.num_nodes(), nodes_per_thread, [&](Index begin, Index end) {
        for (Index k = corners.offsets[begin]; k < corners.offsets[end]; ++k) {
            const Index corner = corners.items[k];
            add_corner(model, geometry[corner / 4], corner / 4, corner % 4, matrix);
        }
    });
    return matrix;
}

void multiply_rows(const StiffnessMatrix& stiffness, Index first, Index last, const double* x,
                   Index columns, std::span<const unsigned char> nonzero, double* y) {
    const Adjacency& graph = stiffness.graph;
    const std::size_t width = columns;
    std::fill(y, y + 3 * width * (last - first), 0.0);
    for (Index n = first; n < last; ++n) {
        double* y0 = y + 3 * width * (n - first);
        double* y1 = y0 + width;
        double* y2 = y1 + width;
        for (Index k = graph.offsets[n]; k < graph.offsets[n + 1]; ++k) {
            const Index m = graph.items[k];
            if (!nonzero.empty() && !nonzero[m]) continue;
            const double* block = &stiffness.blocks[9 * static_cast<std::size_t>(k)];
            const double* x0 = x + 3 * width * m;
            const double* x1 = x0 + width;
            const double* x2 = x1 + width;
            for (std::size_t c = 0; c < width; ++c) {
                y0[c] += block[0] * x0[c] + block[1] * x1[c] + block[2] * x2[c];
                y1[c] += block[3] * x0[c] + block[4] * x1[c] + block[5] * x2[c];
                y2[c] += block[6] * x0[c] + block[7] * x1[c] + block[8] * x2[c];
            }
        }
    }
}

}  // namespace palpate
